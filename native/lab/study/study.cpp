// SPDX-License-Identifier: Apache-2.0
#include "lab/study/study.h"

#include <algorithm>

#include "bake/stages/stages.h"
#include "lab/study/motion/motion.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/run/scene.h"
#include "lab/study/steps/steps.h"
#include "lab/study/tables/report.h"
#include "platform/files.h"

namespace fourdvt::study {
namespace {

constexpr const char* kStudyVersion = "study 8";  // change it to discard kept rows of older builds

StudyContext resolved(const StudyContext& given) {
  StudyContext context = given;
  for (std::string* folder : {&context.options.capture_folder, &context.options.report_folder})
    while (folder->size() > 1 && folder->back() == '/') folder->pop_back();
  if (context.options.sequences.empty()) {
    if (context.options.quick)
      context.options.sequences = {shortestSequence(context).name};
    else
      for (const auto& sequence : context.capture->sequences) context.options.sequences.push_back(sequence.name);
  }
  return context;
}

// Refinement of the study's sequences, shared by all its bakes. Kept on disk, so that a resumed study uses the same.
Result<refine::Refinement> refineStudied(const StudyContext& context) {
  capture::Capture studied = *context.capture;
  std::erase_if(studied.sequences, [&](const capture::CaptureSequence& sequence) {
    const auto& names = context.options.sequences;
    return std::find(names.begin(), names.end(), sequence.name) == names.end();
  });
  const std::string folder = context.work() + "/survey";
  const std::string path = bake::refinementPath(folder, studied, context.options.refine);
  FOURDVT_ASSIGN(auto refinement, bake::loadOrRefine(path, studied, context.options.refine, context.open_video,
                                                     [&](const std::string& what, double) {
                                                       if (context.progress) context.progress({"refine", what, 0});
                                                       return !(context.stop && *context.stop);
                                                     }));
  FOURDVT_TRY(platform::makeFolder(folder));
  FOURDVT_TRY(bake::keepRefinement(path, refinement));
  return refinement;
}

}  // namespace

std::vector<StudyStep> studySteps() {
  return {{"reference", 18, runReference}, {"fvvr", 4, runFvvr},      {"methods", 53, runMethods},
          {"labels", 2, runLabels},        {"layers", 12, runLayers}, {"layer-videos", 28, runLayerVideos},
          {"rate", 10, runRate},           {"codecs", 20, runCodecs}, {"speed", 6, runSpeed},
          {"pictures", 5, runPictures},    {"motion", 40, runMotion}};
}

Result<Rows> runStudy(const StudyContext& given) {
  StudyContext context = resolved(given);
  FOURDVT_ASSIGN(const auto steps, askedSteps(studySteps(), context.options.steps));
  FOURDVT_TRY(openReportFolder(context.options.report_folder, studyKey(context.options, kStudyVersion)));
  const capture::Capture as_given = *context.capture;
  capture::Capture refined = as_given;
  refine::Refinement refinement;
  if (context.options.refine.any()) {
    FOURDVT_ASSIGN(refinement, refineStudied(context));
    refine::applyRefinement(refinement, refined);
    context.refinement = &refinement;
  }
  context.given = &as_given;
  context.capture = &refined;
  return publishSteps(context, steps, [&](const Rows& rows) {
    return makeStudyDocument(rows, context.options, context.capture->name);
  });
}

}  // namespace fourdvt::study

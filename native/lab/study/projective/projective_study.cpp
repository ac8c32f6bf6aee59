// SPDX-License-Identifier: Apache-2.0
#include "lab/study/projective/projective_study.h"

#include <algorithm>

#include "lab/study/projective/setup.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/tables/projective.h"

namespace fourdvt::study {
namespace {

constexpr const char* kVersion = "projective 4";  // change it to discard kept rows of older builds

// Facts for the report's last section.
Result<Rows> runAbout(const StudyContext& context) {
  FOURDVT_ASSIGN(const auto choice, chooseMethods(*context.device, context.options.methods));
  Rows out;
  const auto fact = [&](const char* name, const std::string& text) {
    RowWriter(out, rows::kAbout, "", "", "text=" + text).add({{name, 0}});
  };
  fact(rows::kAboutDevice, context.device->caps().renderer);
  std::string frames;
  for (const auto* sequence : projectiveSequences(context)) {
    frames += (frames.empty() ? "" : "; ") + sequence->name;
    for (const uint32_t frame : spreadTestFrames(*sequence, context.options.test_frames))
      frames.append(" ").append(std::to_string(frame));
  }
  fact("test frames", frames);
  if (context.options.axis_frames > 0) {
    const std::string count = std::to_string(context.options.axis_frames);
    fact("test frames of surfaces that no choice is made on", count + " of each motion");
    fact("test frames where cameras and calibration vary", count + " of the first motion");
  }
  fact("test frames of the cross-validation", std::to_string(crossFrames(context.options)) + " of each motion");
  fact("frames of a run", std::to_string(runFrames(context.options)) + ", from the first test frame, at input camera " +
                              context.capture->cameras[0].pinhole.name);
  for (const std::string& left_out : choice.left_out) fact("method left out", left_out);
  return out;
}

StudyContext resolved(const StudyContext& given) {
  StudyContext context = given;
  for (std::string* folder : {&context.options.capture_folder, &context.options.report_folder})
    while (folder->size() > 1 && folder->back() == '/') folder->pop_back();
  auto sequences = projectiveSequences(context);
  if (context.options.quick && context.options.sequences.empty() && !sequences.empty())
    sequences = {*std::min_element(sequences.begin(), sequences.end(),
                                   [](const auto* a, const auto* b) { return a->frame_count < b->frame_count; })};
  context.options.sequences.clear();
  for (const auto* sequence : sequences) context.options.sequences.push_back(sequence->name);
  return context;
}

}  // namespace

std::vector<const capture::CaptureSequence*> projectiveSequences(const StudyContext& context) {
  std::vector<const capture::CaptureSequence*> out;
  const auto& names = context.options.sequences;
  for (const capture::CaptureSequence& sequence : context.capture->sequences)
    if (!sequence.test_frames.empty() &&
        (names.empty() || std::find(names.begin(), names.end(), sequence.name) != names.end()))
      out.push_back(&sequence);
  return out;
}

uint32_t runFrames(const StudyOptions& options) { return options.quick ? 3 : 4; }

uint32_t crossFrames(const StudyOptions& options) {
  constexpr uint32_t kTestFrames = 3;  // a single frame cannot separate close methods
  if (options.quick) return 1;
  return options.axis_frames > 0 ? std::min(kTestFrames, options.test_frames) : kTestFrames;
}

Result<Rows> runProjectiveStudy(const StudyContext& given) {
  const StudyContext context = resolved(given);
  if (context.options.sequences.empty())
    return Error{ErrorId::FileMissing, context.options.capture_folder +
                                           "/capture.json: no sequence has \"test_frames\", frames with held-out "
                                           "pictures"};
  FOURDVT_ASSIGN(const auto choice, chooseMethods(*context.device, context.options.methods));
  static const StudyStep kSteps[] = {{"about", 0.1, runAbout},
                                     {"proxies", 55, runProxyConditions},
                                     {"cameras", 12, runCameraConditions},
                                     {"calibration", 30, runCalibrationConditions},
                                     {"cross-validation", 12, runCrossValidation},
                                     {"choice", 15, runChoice},
                                     {"stages", 3, runMethodStages},
                                     {"pictures", 12, runMethodPictures}};
  FOURDVT_ASSIGN(const auto steps, askedSteps(kSteps, context.options.steps));
  FOURDVT_TRY(openReportFolder(context.options.report_folder, studyKey(context.options, kVersion)));
  const auto document = [&](const Rows& rows) {
    return makeProjectiveDocument(rows, context.options, context.capture->name);
  };
  return publishSteps(context, steps, document, projectiveConclusions);
}

}  // namespace fourdvt::study

// SPDX-License-Identifier: Apache-2.0
// Time per stage of a new frame (Montage4D, Du et al. 2019, Table 3), on the given mesh, in the first held-out camera.
#include <algorithm>
#include <limits>

#include "lab/study/projective/pass_clock.h"
#include "lab/study/projective/projective_study.h"
#include "lab/study/projective/setup.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/run_steps.h"

namespace fourdvt::study {
namespace {

constexpr const char* kTimed[] = {rows::kFvvr, rows::kMethodHoloportation, rows::kMethodMontage, rows::kMethodFloating,
                                  rows::kMethodSweep};

Result<Rows> timeStages(const StudyContext& context, const std::string& name) {
  PassClock clock(*context.device);
  FOURDVT_TRY(clock.start());
  FOURDVT_ASSIGN(auto setup, ProjectiveSetup::create(context, *context.device));
  const capture::CaptureSequence& sequence = *projectiveSequences(context).front();
  FrameWindow frames(*context.capture, sequence, context.open_video);
  const Condition base;
  const PinholeCamera& view = setup->testCameras().front();
  FOURDVT_ASSIGN(auto methods, setup->make({name}));
  const uint32_t count = std::min(runFrames(context.options), sequence.frame_count);
  for (uint32_t f = 0; f < count; ++f) {
    FOURDVT_TRY(checkStop(context));
    FOURDVT_ASSIGN(const FrameScene scene, setup->scene(base, frames, f));
    if (f == 1) clock.forget();  // the first frame creates programs
    FOURDVT_TRY(setup->show(base, scene, view));
    const float elapsed_s = f ? float(1 / context.capture->fps) : std::numeric_limits<float>::infinity();
    FOURDVT_ASSIGN(const Image drawn, setup->draw(methods[name], base, scene, view, {}, elapsed_s));
  }
  Rows out;
  for (const PassClock::Part& part : clock.parts()) {
    const RowWriter row(out, rows::kStage, sequence.name, name, "proxy=given pass=" + part.label);
    row.add({{rows::kFrameMs, 1e3 * part.seconds / std::max(1u, count - 1)}});
  }
  return out;
}

}  // namespace

Result<Rows> runMethodStages(const StudyContext& context) {
  FOURDVT_ASSIGN(const auto choice, chooseMethods(*context.device, context.options.methods));
  Rows out;
  double done = 0;
  for (const char* name : kTimed) {
    if (std::find(choice.methods.begin(), choice.methods.end(), name) == choice.methods.end()) continue;
    reportProgress(context, "", name, done++ / double(std::size(kTimed)));
    FOURDVT_TRY(addPart(
        context, std::string("stages-") + name, [&] { return timeStages(context, name); }, out));
  }
  return out;
}

}  // namespace fourdvt::study

// SPDX-License-Identifier: Apache-2.0
// The bake's choice of a method (bake/method/method_trial.h) under each condition: from the input cameras alone, on the
// condition's measured frames.
#include "bake/method/method_choice.h"
#include "bake/method/method_trial.h"
#include "lab/study/projective/projective_study.h"
#include "lab/study/projective/setup.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/run_steps.h"

namespace fourdvt::study {
namespace {

using namespace rows;

using Sequences = std::vector<const capture::CaptureSequence*>;

std::vector<Condition> allConditions(bool quick) {
  std::vector<Condition> out = proxyConditions(quick);
  for (const auto& more : {cameraConditions(quick), calibrationConditions(quick)})
    out.insert(out.end(), more.begin(), more.end());
  return out;
}

// Methods of the study within the rule's cost on such a surface.
std::vector<std::string> candidates(const ProjectiveSetup& setup, size_t faces, const bake::ChoiceRule& rule) {
  std::vector<std::string> out;
  for (const std::string& name : bake::methodCandidates())
    if (std::find(setup.methods().begin(), setup.methods().end(), name) != setup.methods().end() &&
        bake::methodCost(name, faces) <= rule.most_cost)
      out.push_back(name);
  return out;
}

struct Tried {
  bake::TrialSums sums;
  size_t faces = 0;
};

Status tryFrame(ProjectiveSetup& setup, const Condition& condition, const FrameScene& scene, Tried& tried) {
  const auto cameras = miscalibrated(setup.cameras(), condition);
  render::MethodOptions options;
  options.closest = condition.closest;
  if (tried.faces == 0) tried.faces = scene.surface.faces.size();
  const auto methods = candidates(setup, tried.faces, {});
  const auto tryOn = [&](const TriangleMesh& surface, std::span<const size_t> left_out) -> Status {
    const bake::TrialFrame frame{cameras, surface, scene.pictures};
    FOURDVT_ASSIGN(const auto sums,
                   bake::tryMethods(*setup.context().device, setup.stage(), frame, left_out, methods, options));
    bake::add(sums, tried.sums);
    return {};
  };
  FOURDVT_TRY(setup.show(condition, scene, cameras[0]));
  const auto left_out = bake::trialCameras({cameras, scene.surface, scene.pictures});
  if (!scene.plane) return tryOn(scene.surface, left_out);
  for (const size_t camera : left_out) {  // each has a plane of its own
    FOURDVT_TRY(setup.show(condition, scene, cameras[camera]));
    FOURDVT_TRY(tryOn(facingPlane(scene.surface.positions, cameras[camera]), {&camera, 1}));
  }
  return {};
}

Rows rowsOf(const Condition& condition, const Tried& tried) {
  Rows out;
  const std::string setting = condition.setting() + " views=" + std::to_string(tried.sums.views);
  if (tried.sums.views == 0) {
    RowWriter(out, kTried, "", bake::kUnmeasuredMethod, setting).add({{kTaken, 1}});
    return out;
  }
  const bake::LeftOut views = bake::meanViews(tried.sums);
  const auto choice = bake::chooseMethod(bake::meanScores(tried.sums, tried.faces), views);
  RowWriter(out, kTried, "", "", setting).add({{kShiftPx, views.shift_px}});
  for (const bake::MethodVerdict& v : choice.verdicts) {
    const RowWriter row(out, kTried, "", v.score.method, setting);
    row.add({{kBlendedDb, v.score.psnr_db},
             {kBlendedSsim, v.score.ssim},
             {kOwnDb, v.score.own_psnr_db},
             {kPsnrFgDb, v.score.psnr_fg_db},
             {kSsimFg, v.score.ssim_fg},
             {kStatedCost, v.score.cost}});
    if (v.score.method == choice.method) row.add({{kTaken, 1}});
  }
  return out;
}

Result<Rows> tryCondition(ProjectiveSetup& setup, const Condition& condition, const Sequences& sequences) {
  const StudyOptions& options = setup.context().options;
  const bool few = options.axis_frames > 0 && !condition.all_methods;
  Tried tried;
  for (const auto* sequence : sequences) {
    if (few && sequence != sequences.front()) break;  // matches its rows at the held-out cameras
    FrameWindow frames(*setup.context().capture, *sequence, setup.context().open_video);
    for (const uint32_t frame : spreadTestFrames(*sequence, few ? options.axis_frames : options.test_frames)) {
      FOURDVT_TRY(checkStop(setup.context()));
      FOURDVT_ASSIGN(const FrameScene scene, setup.scene(condition, frames, frame));
      FOURDVT_TRY(tryFrame(setup, condition, scene, tried));
    }
  }
  return rowsOf(condition, tried);
}

}  // namespace

Result<Rows> runChoice(const StudyContext& context) {
  FOURDVT_ASSIGN(auto setup, ProjectiveSetup::create(context, *context.device));
  const auto sequences = projectiveSequences(context);
  const auto conditions = allConditions(context.options.quick);
  Rows out;
  for (size_t i = 0; i < conditions.size(); ++i) {
    reportProgress(context, "", conditions[i].name(), double(i) / double(conditions.size()));
    FOURDVT_TRY(addPart(
        context, "choice-" + conditions[i].name(), [&] { return tryCondition(*setup, conditions[i], sequences); },
        out));
  }
  return out;
}

}  // namespace fourdvt::study

// SPDX-License-Identifier: Apache-2.0
// Scores each condition's methods: at the held-out cameras, and on consecutive frames at an input camera that is left
// out.
#include <algorithm>
#include <cmath>

#include "base/robust.h"
#include "base/watch.h"
#include "lab/measure/appearance_score.h"
#include "lab/measure/held_out_truth.h"
#include "lab/study/projective/projective_study.h"
#include "lab/study/projective/setup.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/tables/projective.h"

namespace fourdvt::study {
namespace {

using namespace rows;

constexpr size_t kRunCamera = 0;  // index among the capture's; viewpoint of the run

struct RunValues {
  std::vector<double> flicker, seconds;
  double view_s = std::nan("");
};

// Viewpoint of a visitor a moment later.
PinholeCamera movedABit(PinholeCamera view) {
  view.cam_from_world[3].x -= 0.02;
  return view;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  size_t count = 0;
  for (const double v : values)
    if (!std::isnan(v)) sum += v, ++count;
  return count ? sum / double(count) : std::nan("");
}

// Median, since other load of the machine lengthens single frames.
double usual(const std::vector<double>& values) { return median(values, std::nan("")); }

class ConditionPart {
 public:
  ConditionPart(ProjectiveSetup& setup, const Condition& condition, FrameWindow& frames)
      : setup_(setup), condition_(condition), frames_(frames), names_(setup.methodsOf(condition)) {}

  Result<Rows> run() {
    FOURDVT_ASSIGN(methods_, setup_.make(names_));
    FOURDVT_TRY(heldOut());
    if (isJudged() || setup_.context().options.axis_frames == 0) FOURDVT_TRY(consecutive());
    return write();
  }

 private:
  // True if the method is chosen by this condition.
  bool isJudged() const {
    const auto& judged = judgedProxies();
    return condition_.axis == kAxisProxy && std::find(judged.begin(), judged.end(), condition_.at) != judged.end();
  }
  uint32_t testFrames() const {
    const StudyOptions& options = setup_.context().options;
    return isJudged() || options.axis_frames == 0 ? options.test_frames : options.axis_frames;
  }
  Status heldOut();
  Status consecutive();
  Rows write();

  ProjectiveSetup& setup_;
  const Condition& condition_;
  FrameWindow& frames_;
  const std::vector<std::string> names_;
  std::map<std::string, ProjectiveSetup::Shared> methods_;
  std::map<std::string, std::vector<std::pair<std::string, measure::AppearanceScore>>> scores_;
  std::map<std::string, RunValues> runs_;
};

Status ConditionPart::heldOut() {
  const StudyContext& context = setup_.context();
  std::map<std::string, measure::AppearanceLane> lanes;
  for (const uint32_t frame : spreadTestFrames(frames_.sequence(), testFrames())) {
    FOURDVT_ASSIGN(const FrameScene scene, setup_.scene(condition_, frames_, frame));
    bool shown = false;
    for (const PinholeCamera& camera : setup_.testCameras()) {
      FOURDVT_TRY(checkStop(context));
      if (!shown || scene.plane) FOURDVT_TRY(setup_.show(condition_, scene, camera));
      shown = true;
      setup_.stage().leaveOut({});
      FOURDVT_ASSIGN(const Image truth, measure::heldOutTruth(frames_.sequence(), camera, frame));
      for (const std::string& name : names_) {
        FOURDVT_ASSIGN(auto picture, setup_.draw(methods_[name], condition_, scene, camera, truth, kStill));
        lanes[name].add(truth, std::move(picture), "view=" + camera.name + " frame=" + std::to_string(frame));
      }
    }
  }
  for (auto& [name, lane] : lanes) scores_[name] = lane.finish();
  return {};
}

Status ConditionPart::consecutive() {
  const StudyContext& context = setup_.context();
  const capture::CaptureSequence& sequence = frames_.sequence();
  const uint32_t count = std::min(sequence.frame_count, runFrames(context.options));
  const uint32_t middle = spreadTestFrames(sequence, context.options.test_frames).front();
  const uint32_t first = std::min(middle, sequence.frame_count - count);
  const PinholeCamera& view = setup_.cameras()[kRunCamera];
  const bool tracked = context.capture->meshes == capture::CaptureMeshes::ConstantTopology;
  std::map<std::string, measure::TrueAndDrawn> before;
  Positions mesh_before;
  for (uint32_t f = first; f < first + count; ++f) {
    FOURDVT_TRY(checkStop(context));
    FOURDVT_ASSIGN(const FrameScene scene, setup_.scene(condition_, frames_, f));
    FOURDVT_ASSIGN(const auto* captured, frames_.at(f));
    const Image truth = inputTruth(captured->pictures[kRunCamera]);
    FOURDVT_TRY(setup_.show(condition_, scene, view));
    measure::FlowField motion;
    if (tracked) {
      FOURDVT_ASSIGN(auto mesh, capture::readMeshFrame(*context.capture, sequence, f));
      if (f > first) motion = measure::visibleMotion(view, context.capture->topology.face_vertices, mesh_before, mesh);
      mesh_before = std::move(mesh);
    }
    for (const std::string& name : names_) {
      setup_.stage().leaveOut({&kRunCamera, 1});  // a new frame: clears the methods' temporal state
      const float elapsed_s = f == first ? kStill : float(1 / context.capture->fps);
      const Watch watch;
      FOURDVT_ASSIGN(auto picture, setup_.draw(methods_[name], condition_, scene, view, truth, elapsed_s));
      const double seconds = watch.seconds();
      measure::TrueAndDrawn now{truth, std::move(picture)};
      if (f > first) {
        runs_[name].seconds.push_back(seconds);
        if (tracked) runs_[name].flicker.push_back(measure::flickerLevels(before[name], now, motion));
      }
      before[name] = std::move(now);
      if (f + 1 < first + count || !condition_.all_methods || scene.plane) continue;
      const Watch again;
      FOURDVT_ASSIGN(picture, setup_.draw(methods_[name], condition_, scene, movedABit(view), truth, elapsed_s));
      runs_[name].view_s = again.seconds();
    }
  }
  return {};
}

Rows ConditionPart::write() {
  Rows out;
  const double fvvr_s = usual(runs_[kFvvr].seconds);
  for (const std::string& name : names_) {
    std::vector<measure::AppearanceScore> scores;
    for (const auto& [view, score] : scores_[name]) {
      scores.push_back(score);
      const std::string place = "axis=" + condition_.axis + " at=" + condition_.at + " " + view;
      const RowWriter row(out, kConditionView, frames_.sequence().name, name, place);
      row.add({{kPsnrFgDb, score.picture.psnr_fg_db}, {kSsimFg, score.picture.ssim_fg}});
    }
    const measure::AppearanceScore m = measure::meanAppearance(scores);
    const std::string setting = condition_.setting() + " views=" + std::to_string(scores.size());
    const RowWriter row(out, kCondition, frames_.sequence().name, name, setting);
    row.add({{kPsnrFgDb, m.picture.psnr_fg_db},
             {kSsimFg, m.picture.ssim_fg},
             {kPsnrCommonDb, m.picture.psnr_common_db},
             {kRmse, m.rmse},
             {kGradientRatio, m.gradient_ratio},
             {kShiftTolerantDb, m.shift_tolerant_db}});
    const RunValues& run = runs_[name];
    if (const double flicker = mean(run.flicker); !std::isnan(flicker)) row.add({{kFlickerLevels, flicker}});
    const double frame_s = usual(run.seconds);
    if (std::isnan(frame_s)) continue;
    row.add({{kFrameS, frame_s}});
    if (!std::isnan(fvvr_s)) row.add({{kRatioToFvvr, frame_s / fvvr_s}});
    if (!std::isnan(run.view_s)) row.add({{kViewS, run.view_s}});
  }
  return out;
}

Result<Rows> measureAll(const StudyContext& context, const std::vector<Condition>& conditions) {
  FOURDVT_ASSIGN(auto setup, ProjectiveSetup::create(context, *context.device));
  const auto sequences = projectiveSequences(context);
  Rows out;
  double done = 0;
  for (const auto* sequence : sequences) {
    FrameWindow frames(*context.capture, *sequence, context.open_video);
    for (const Condition& condition : conditions) {
      // Limits cameras and calibration, which take most of the time and decide no choice.
      if (context.options.axis_frames > 0 && !condition.all_methods && sequence != sequences.front()) continue;
      reportProgress(context, "", sequence->name + ", " + condition.name(),
                     done++ / double(sequences.size() * conditions.size()));
      FOURDVT_TRY(addPart(
          context, condition.name() + "-" + sequence->name,
          [&] { return ConditionPart(*setup, condition, frames).run(); }, out));
    }
  }
  return out;
}

}  // namespace

Result<Rows> runProxyConditions(const StudyContext& context) {
  return measureAll(context, proxyConditions(context.options.quick));
}
Result<Rows> runCameraConditions(const StudyContext& context) {
  return measureAll(context, cameraConditions(context.options.quick));
}
Result<Rows> runCalibrationConditions(const StudyContext& context) {
  return measureAll(context, calibrationConditions(context.options.quick));
}

}  // namespace fourdvt::study

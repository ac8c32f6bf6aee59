// SPDX-License-Identifier: Apache-2.0
// Goals of motion: each is a claim, the measured values, and, if it fails, a hint to the cause.
#include <algorithm>
#include <cmath>

#include "lab/study/run/rows.h"
#include "lab/study/tables/sections.h"

namespace fourdvt::study {
namespace {

using namespace rows;

constexpr double kMaxBlendMm = 1, kMaxFlowPx = 0.3, kMinGradient = 0.95, kMaxCost = 1.3, kMaxLatency_s = 0.4;
// Rounding of pictures to whole levels: share of a mean change of 40, a tenth of a level.
constexpr double kChangeRounding = 0.0025;

// Maximum of a quantity, or of its ratio to another, over the rows of a table.
double largest(const StudyValues& v, const char* table, const char* quantity, const char* over = nullptr) {
  double most = kNaN;
  for (const Row& row : v.rows()) {
    if (row.table != table || row.quantity != quantity) continue;
    const double value = over ? row.value / v.of(table, row.sequence, row.method, row.setting, over) : row.value;
    most = std::isnan(most) ? value : std::max(most, value);
  }
  return most;
}

Judgement blendGoal(const StudyValues& v) {
  const double error = v.mean(kMotionBlend, kHybrid, "baked=1", kErrorMaxMm);
  return judged("Hybrid mesh blend, as baked: at most 1 mm from the non-linear one", error, error <= kMaxBlendMm,
                fixed<2>(error) + " mm", "See the table for what more corrections would leave.");
}

Judgement flowGoal(const StudyValues& v) {
  const double difference = v.mean(kMotionFlow, kFlowGpu, "against=opencv", kDifferenceMeanPx);
  return judged("flow-gpu within 0.3 px of OpenCV's Farnebäck in the mean", difference, difference <= kMaxFlowPx,
                fixed<3>(difference) + " px", "See the 95th percentile: whether few pixels or all differ.");
}

// Judges the mean over w of 0.2 … 0.8, true mesh, common foreground.
void truthGoals(const StudyValues& v, std::vector<Judgement>& out) {
  const auto meanOf = [&](const char* method) {
    double sum = 0, count = 0;
    for (const double w : v.numbers(kMotionAppearance, method, "w")) {
      sum += v.mean(kMotionAppearance, method, "w=" + fixed<2>(w) + " mesh=truth region=common", kPsnrFgDb);
      ++count;
    }
    return count ? sum / count : kNaN;
  };
  const double none = meanOf(kAlignNone), baked = meanOf(kAlignBaked),
               flow = std::max(meanOf(kFlowGpu), meanOf(kFlowOpencv));
  const std::string measured =
      "none " + fixed<2>(none) + ", run-time flow " + fixed<2>(flow) + ", baked " + fixed<2>(baked) + " dB";
  out.push_back(judged("Truth between the members: baked at least as good as run-time Farnebäck", baked - flow,
                       baked >= flow, measured, "See the end-point errors for where the baked alignment is off."));
  out.push_back(judged("Truth between the members: flow and baked above the plain blend", baked + flow - 2 * none,
                       std::min(baked, flow) > none, measured,
                       "Where appearance hardly differs there is nothing to align."));
}

Judgement sharpnessGoal(const StudyValues& v) {
  const double none = v.mean(kMotionSharpness, kAlignNone, "w=0.50", kGradientRatio),
               baked = v.mean(kMotionSharpness, kAlignBaked, "w=0.50", kGradientRatio),
               flow = v.mean(kMotionSharpness, kFlowGpu, "w=0.50", kGradientRatio);
  return judged("Half way as sharp as the members: gradient energy at least 0.95 with baked alignment, less without",
                baked - none, baked >= kMinGradient && baked > none, fixed<3>(baked) + ", plain " + fixed<3>(none),
                "Run-time flow keeps " + fixed<3>(flow) +
                    ". What is missing is detail that the members do not share: codec noise, folds, other cameras.");
}

void costGoals(const StudyValues& v, std::vector<Judgement>& out) {
  double most = kNaN, characters = kNaN;
  for (const std::string& size : v.settings(kMotionCost, "", "size")) {
    const double ratio = v.mean(kMotionCost, kAlignBaked, "size=" + size, kRatioToNone);
    most = std::isnan(most) ? ratio : std::max(most, ratio);
    const double count = v.mean(kMotionCost, kAlignBaked, "size=" + size, kCharactersPerFlow);
    characters = std::isnan(characters) ? count : std::min(characters, count);
  }
  out.push_back(
      judged("Baked alignment at most 1.3 × the plain blend", most, most <= kMaxCost, fixed<2>(most) + " ×", ""));
  out.push_back(judged("More than one baked character in the time of one with run-time flow", characters,
                       characters > 1, fixed<2>(characters), ""));
}

void transitionGoals(const StudyValues& v, std::vector<Judgement>& out) {
  const double latency =
      std::max(largest(v, kMotionTransitions, kLatencyMaxS), largest(v, kMotionTransitions, kLatencyPlayedS));
  out.push_back(judged("Transitions are seen within 0.4 s of the request", latency, latency <= kMaxLatency_s + 1e-9,
                       secondsText(latency) + " at most, as planned and as played",
                       "See which pair waits; the player prepares the target first."));
  const double step = largest(v, kMotionTransitions, kStepMm, kOwnStepMm),
               change = largest(v, kMotionTransitions, kChangeLevels, kOwnChangeLevels);
  out.push_back(
      judged("No pop: in transitions, vertices and pictures change no more than in the motions themselves",
             std::max(step, change), step <= 1 + 1e-9 && change <= 1 + kChangeRounding,
             fixed<3>(step) + " × (vertices), " + fixed<3>(change) + " × (picture, to a tenth of a level)",
             "The worst pair; where a slow motion is entered from far away, the fade itself moves the mesh."));
}

}  // namespace

std::vector<Judgement> judgeMotion(const StudyValues& v) {
  std::vector<Judgement> goals{blendGoal(v), flowGoal(v)};
  truthGoals(v, goals);
  goals.push_back(sharpnessGoal(v));
  costGoals(v, goals);
  transitionGoals(v, goals);
  return goals;
}

}  // namespace fourdvt::study

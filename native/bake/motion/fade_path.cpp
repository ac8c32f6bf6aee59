// SPDX-License-Identifier: Apache-2.0
#include "bake/motion/fade_path.h"

#include <algorithm>
#include <cmath>

#include "motion/motion_graph.h"
#include "motion/placement.h"

namespace fourdvt::bake {
namespace {

using motion::moved;
using motion::Placement;

constexpr double kRounding = 1e-6;
constexpr double kStill_m = 0.002;  // steps of motions that hardly move count as at least this long

Step stepBetween(const Positions& before, const Positions& after, const Placement& moved_by) {
  const glm::mat4 move = motion::worldFromCharacter(moved_by);
  Step step;
  for (size_t v = 0; v < after.size(); ++v) {
    const double far = glm::distance(before[v], glm::vec3(move * glm::vec4(after[v], 1)));
    step.furthest = std::max(step.furthest, far);
    step.mean += far / double(after.size());
  }
  return step;
}

Step larger(const Step& a, const Step& b) { return {std::max(a.furthest, b.furthest), std::max(a.mean, b.mean)}; }

double ratio(const Step& step, const Step& limit) {
  return std::max(step.furthest / std::max(limit.furthest, kStill_m), step.mean / std::max(limit.mean, kStill_m));
}

// A motion that does not loop stays on its last frame.
uint32_t frameAt(const MotionPath& path, int64_t frame) {
  const int64_t count = int64_t(path.positions.size());
  return uint32_t(path.loop ? (frame % count + count) % count : std::clamp<int64_t>(frame, 0, count - 1));
}

// The largest number of frames that pass between two ticks.
int64_t framesPerTick(const MotionPath& path, double tick_s) {
  return std::max<int64_t>(1, int64_t(std::ceil(path.frames_per_s * tick_s - kRounding)));
}

glm::vec3 rootStep(const MotionPath& path, int64_t frame, int64_t frames) {
  glm::vec3 step(0);
  for (int64_t t = frame; t < frame + frames; ++t)
    if (path.loop || (t >= 0 && t + 1 < int64_t(path.positions.size()))) step += path.root_steps[frameAt(path, t)];
  return step;
}

glm::vec3 inverse(const glm::vec3& step) { return motion::stepBetween(step, glm::vec3(0)); }

}  // namespace

Steps larger(const Steps& a, const Steps& b) {
  return {larger(a.in_place, b.in_place), larger(a.travelling, b.travelling)};
}

std::vector<Steps> ownSteps(const MotionPath& path, double tick_s) {
  std::vector<Steps> own;
  const int64_t count = int64_t(path.positions.size()), frames = framesPerTick(path, tick_s);
  for (int64_t t = 0; t < count; ++t) {
    const Positions &before = path.positions[size_t(t)], &after = path.positions[frameAt(path, t + frames)];
    own.push_back({stepBetween(before, after, {}), stepBetween(before, after, moved({}, rootStep(path, t, frames)))});
  }
  return own;
}

double popOf(const MotionPath& source, const MotionPath& target, const Fade& fade, const PopScale& scale,
             const PopOptions& options) {
  const glm::mat4 source_from_target = motion::worldFromCharacter(moved({}, fade.shift));
  // The faded mesh in the source's character frame.
  const auto faded = [&](int64_t source_frame, int64_t target_frame, float weight) {
    Positions points = source.positions[frameAt(source, source_frame)];
    const Positions& entered = target.positions[frameAt(target, target_frame)];
    for (size_t v = 0; v < points.size(); ++v)
      points[v] += weight * (glm::vec3(source_from_target * glm::vec4(entered[v], 1)) - points[v]);
    return points;
  };
  const auto weightAt = [&](double k) { return k < -kRounding ? 0 : motion::fadeWeight(k, fade.frames); };
  const int64_t source_frames = framesPerTick(source, options.tick_s),
                target_frames = framesPerTick(target, options.tick_s);
  double largest = 0;
  for (int64_t k = -1; k < int64_t(fade.frames) && largest <= scale.enough; ++k) {
    const int64_t left =
        fade.source_frame + int64_t(std::floor(k * source.frames_per_s / target.frames_per_s + kRounding));
    const int64_t entered = fade.target_frame + k;
    const float before = weightAt(k), after = weightAt(k + options.tick_s * target.frames_per_s),
                middle = (before + after) / 2;
    const Positions from = faded(left, entered, before);
    const Positions to = faded(left + source_frames, entered + target_frames, after);
    // In place, the placement is faded from the source's to the target's.
    const Placement in_place =
        moved({}, motion::stepBetween(inverse(before * fade.shift), inverse(after * fade.shift)));
    const Placement led = moved(moved({}, (1 - middle) * rootStep(source, left, source_frames)), fade.shift);
    const Placement travelling =
        moved(moved(led, middle * rootStep(target, entered, target_frames)), inverse(fade.shift));
    Steps limit = larger(source.steps[frameAt(source, left)], target.steps[frameAt(target, entered)]);
    const auto allow = [&](Step& now, const Step& ever) {
      now = {ever.furthest, std::max(now.mean, options.mean_share * ever.mean)};
    };
    allow(limit.in_place, scale.own.in_place);
    allow(limit.travelling, scale.own.travelling);
    largest = std::max(largest, ratio(stepBetween(from, to, travelling), limit.travelling));
    if (glm::length(glm::vec2(fade.shift)) <= options.furthest_shift_m)
      largest = std::max(largest, ratio(stepBetween(from, to, in_place), limit.in_place));
  }
  return largest;
}

}  // namespace fourdvt::bake

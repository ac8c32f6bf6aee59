// SPDX-License-Identifier: Apache-2.0
#include "bake/motion/time_warp.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fourdvt::bake {
namespace {

constexpr float kPassVelocityWeight = 0.04f;  // of squared metres per pass
constexpr int kStepsAPhase = 8;               // steps per phase at mean pace: the resolution of the search
constexpr double kMaxPace = 3;                // times the mean pace; the slowest pace is its inverse
constexpr double kPaceCost = 0.02;            // cost of a pace twice the mean, in mean distances
constexpr int kCoarseStarts = 64;             // starts tried in a loop before refining
constexpr int kSmoothings = 2;                // passes of the filter 1 4 6 4 1
constexpr double kFar = std::numeric_limits<double>::max();

size_t wrapped(long index, size_t count) { return size_t((index % long(count) + long(count)) % long(count)); }

// The distances of every phase to every step of the member, and the cheapest paths through them.
class Grid {
 public:
  Grid(const PoseFeatures& reference, const PoseFeatures& member, bool loop)
      : phases_(reference.size()), frames_(member.size()), loop_(loop) {
    steps_a_frame_ = int((kStepsAPhase * phases_ + frames_ - 1) / frames_);
    steps_a_frame_ = std::max(steps_a_frame_, 4);
    total_ = (loop ? frames_ : frames_ - 1) * size_t(steps_a_frame_);
    intervals_ = loop ? phases_ : phases_ - 1;
    const double mean_step = double(total_) / double(intervals_);
    min_step_ = std::max<size_t>(1, size_t(std::ceil(mean_step / kMaxPace)));
    max_step_ = size_t(std::floor(mean_step * kMaxPace));
    measure(reference, member);
    for (size_t s = 0; s <= max_step_; ++s) {
      const double excess = double(s) / mean_step - 1;
      pace_cost_.push_back(kPaceCost * mean_ * excess * excess);
    }
  }

  size_t positions() const { return total_; }
  int stepsAFrame() const { return steps_a_frame_; }

  // The cheapest path that starts at step `start`; [phase] steps since the start.
  double path(size_t start, std::vector<size_t>& steps) const {
    const size_t width = total_ + 1;
    std::vector<double> cost(width, kFar), next(width);
    std::vector<uint32_t> taken(width * (intervals_ + 1), 0);
    cost[0] = distance(0, start);
    for (size_t p = 1; p <= intervals_; ++p) {
      std::fill(next.begin(), next.end(), kFar);
      const size_t last = std::min(total_ - std::min(total_, (intervals_ - p) * min_step_), p * max_step_);
      for (size_t at = p * min_step_; at <= last; ++at) {
        uint32_t& step = taken[p * width + at];
        for (size_t s = min_step_; s <= max_step_ && s <= at; ++s) {
          if (cost[at - s] == kFar) continue;
          const double through = cost[at - s] + pace_cost_[s];
          if (through < next[at]) {
            next[at] = through;
            step = uint32_t(s);
          }
        }
        // In a loop, the phase after the last is the first again.
        if (next[at] < kFar && p < phases_) next[at] += distance(p, start + at);
      }
      cost.swap(next);
    }
    steps.assign(phases_, 0);
    size_t at = total_;
    for (size_t p = intervals_; p > 0; --p) {
      if (p < phases_) steps[p] = at;
      at -= taken[p * width + at];
    }
    return cost[total_];
  }

 private:
  void measure(const PoseFeatures& reference, const PoseFeatures& member) {
    const size_t columns = loop_ ? total_ : total_ + 1;
    distances_.assign(phases_ * columns, 0);
    std::vector<float> pose(reference[0].size());
    for (size_t c = 0; c < columns; ++c) {
      const size_t frame = c / size_t(steps_a_frame_);
      const float share = float(c % size_t(steps_a_frame_)) / float(steps_a_frame_);
      const auto& a = member[frame];
      const auto& b = member[loop_ ? (frame + 1) % frames_ : std::min(frame + 1, frames_ - 1)];
      for (size_t i = 0; i < pose.size(); ++i) pose[i] = a[i] + share * (b[i] - a[i]);
      for (size_t p = 0; p < phases_; ++p) {
        float sum = 0;
        for (size_t i = 0; i < pose.size(); ++i) sum += (pose[i] - reference[p][i]) * (pose[i] - reference[p][i]);
        distances_[p * columns + c] = sum;
        mean_ += sum;
      }
    }
    mean_ /= double(distances_.size());
  }
  double distance(size_t phase, size_t step) const {
    return loop_ ? distances_[phase * total_ + step % total_] : distances_[phase * (total_ + 1) + step];
  }

  size_t phases_, frames_, total_ = 0, intervals_ = 0, min_step_ = 1, max_step_ = 1;
  bool loop_;
  int steps_a_frame_ = 1;
  std::vector<float> distances_;
  std::vector<double> pace_cost_;  // [step]
  double mean_ = 0;
};

// Finds where the cheapest cyclic path starts: by a coarse scan, then by halving the interval round the best.
size_t bestStart(const Grid& grid) {
  std::vector<size_t> steps;
  const size_t count = grid.positions();
  size_t stride = std::max<size_t>(1, count / kCoarseStarts), best = 0;
  double least = kFar;
  const auto consider = [&](size_t start) {
    const double cost = grid.path(start, steps);
    if (cost < least) {
      least = cost;
      best = start;
    }
  };
  for (size_t start = 0; start < count; start += stride) consider(start);
  while (stride > 1) {
    stride = (stride + 1) / 2;
    const size_t centre = best;
    consider(wrapped(long(centre) - long(stride), count));
    consider((centre + stride) % count);
  }
  return best;
}

// Smooths a path by averaging neighbours' departures from the mean pace, which keeps paces within their bounds. A path
// that is no loop is mirrored at its ends, so that they do not move.
void smooth(std::vector<double>& time, double pass, bool loop) {
  const long count = long(time.size());
  const auto at = [&](const std::vector<double>& from, long i) {
    if (loop) return from[wrapped(i, size_t(count))] + pass * std::floor(double(i) / double(count));
    if (i < 0) return 2 * from[0] - from[size_t(std::min(-i, count - 1))];
    if (i >= count) return 2 * from[size_t(count - 1)] - from[size_t(std::max(2 * count - 2 - i, 0l))];
    return from[size_t(i)];
  };
  for (int pass_index = 0; pass_index < kSmoothings; ++pass_index) {
    const std::vector<double> from = time;
    for (long i = 0; i < count; ++i) {
      time[size_t(i)] =
          (at(from, i - 2) + at(from, i + 2) + 4 * (at(from, i - 1) + at(from, i + 1)) + 6 * from[size_t(i)]) / 16;
    }
  }
}

}  // namespace

std::vector<uint32_t> spreadVertices(const Positions& positions, size_t count) {
  std::vector<uint32_t> chosen;
  std::vector<float> distance(positions.size(), std::numeric_limits<float>::max());
  uint32_t next = 0;
  while (chosen.size() < std::min(count, positions.size())) {
    chosen.push_back(next);
    for (size_t v = 0; v < positions.size(); ++v) {
      const glm::vec3 d = positions[v] - positions[chosen.back()];
      distance[v] = std::min(distance[v], glm::dot(d, d));
    }
    next = uint32_t(std::max_element(distance.begin(), distance.end()) - distance.begin());
  }
  return chosen;
}

PoseFeatures poseFeatures(const std::vector<Positions>& frames, bool loop) {
  const long count = long(frames.size());
  std::vector<Positions> poses = frames;
  for (Positions& pose : poses) {
    glm::vec3 mean(0);
    for (const glm::vec3& p : pose) mean += p / float(pose.size());
    for (glm::vec3& p : pose) p -= glm::vec3(mean.x, 0, mean.z);
  }
  PoseFeatures features(frames.size());
  const float pose_scale = 1 / std::sqrt(float(poses[0].size()));
  for (long t = 0; t < count; ++t) {
    const long before = loop ? long(wrapped(t - 1, size_t(count))) : std::max(t - 1, 0l);
    const long after = loop ? long(wrapped(t + 1, size_t(count))) : std::min(t + 1, count - 1);
    const float intervals = loop ? 2 : float(std::max(after - before, 1l));
    const float velocity_scale = pose_scale * std::sqrt(kPassVelocityWeight) * float(count) / intervals;
    for (size_t v = 0; v < poses[0].size(); ++v) {
      const glm::vec3 p = pose_scale * poses[size_t(t)][v];
      const glm::vec3 velocity = velocity_scale * (poses[size_t(after)][v] - poses[size_t(before)][v]);
      features[size_t(t)].insert(features[size_t(t)].end(), {p.x, p.y, p.z, velocity.x, velocity.y, velocity.z});
    }
  }
  return features;
}

std::vector<double> warpTime(const PoseFeatures& reference, const PoseFeatures& member, bool loop) {
  std::vector<double> time(reference.size(), 0);
  if (reference.size() < 2 || member.size() < 2) return time;
  const Grid grid(reference, member, loop);
  const size_t start = loop ? bestStart(grid) : 0;
  std::vector<size_t> steps;
  grid.path(start, steps);
  for (size_t p = 0; p < time.size(); ++p) time[p] = double(start + steps[p]) / grid.stepsAFrame();
  smooth(time, double(member.size()), loop);
  if (loop && time[0] < 0)
    for (double& t : time) t += double(member.size());
  return time;
}

}  // namespace fourdvt::bake

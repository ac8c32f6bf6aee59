// SPDX-License-Identifier: Apache-2.0
#include "bake/motion/time_warp.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fourdvt::bake {
namespace {

constexpr float kPassVelocityWeight = 0.04f;  // weight of squared metres per pass
constexpr int kStepsAPhase = 8;               // steps per phase at mean pace: the resolution of the search
constexpr double kMaxPace = 3;                // times the mean pace; the slowest pace is its inverse
constexpr double kPaceCost = 0.02;            // cost of a pace twice the mean, in mean distances
constexpr int kCoarseStarts = 64;             // starts tried in a loop before refining
constexpr int kSmoothings = 2;                // passes of the filter 1 4 6 4 1
constexpr double kFar = std::numeric_limits<double>::max();

size_t wrapped(long index, size_t count) { return size_t((index % long(count) + long(count)) % long(count)); }

// Allowed steps of a path in each phase; absolute, so that those of a loop may be negative or beyond its end.
struct Band {
  std::vector<long> first;  // [phase]; empty: all steps
  size_t width = 0;         // steps in a phase
  double mean = 0;          // mean distance, of the whole grid
  bool whole() const { return first.empty(); }
};

// Distances between phases and steps of the member, and the cheapest paths through them.
class Grid {
 public:
  Grid(const PoseFeatures& reference, const PoseFeatures& member, bool loop, Band band = {})
      : phases_(reference.size()), frames_(member.size()), loop_(loop), band_(std::move(band)) {
    steps_a_frame_ = stepsAFrame(phases_, frames_);
    total_ = (loop ? frames_ : frames_ - 1) * size_t(steps_a_frame_);
    intervals_ = loop ? phases_ : phases_ - 1;
    const double mean_step = double(total_) / double(intervals_);
    min_step_ = std::max<size_t>(1, size_t(std::ceil(mean_step / kMaxPace)));
    max_step_ = size_t(std::floor(mean_step * kMaxPace));
    if (band_.whole())
      measure(reference, member);
    else
      measureBand(reference, member);
    for (size_t s = 0; s <= max_step_; ++s) {
      const double excess = double(s) / mean_step - 1;
      pace_cost_.push_back(kPaceCost * mean_ * excess * excess);
    }
  }

  static int stepsAFrame(size_t phases, size_t frames) {
    return std::max(int((kStepsAPhase * phases + frames - 1) / frames), 4);
  }
  size_t positions() const { return total_; }
  int stepsAFrame() const { return steps_a_frame_; }
  double meanDistance() const { return mean_; }

  // The cheapest path that starts at step `start`; [phase] steps since the start. kFar if the band has none.
  double path(long start, std::vector<size_t>& steps) const {
    const size_t width = total_ + 1, row = band_.whole() ? width : band_.width;
    std::vector<double> cost(width, kFar), next(width, kFar);
    std::vector<uint32_t> taken(row * (intervals_ + 1), 0);
    Range known{0, 0}, stale{0, 0};  // ranges of `cost` and `next`
    cost[0] = distance(0, start);
    for (size_t p = 1; p <= intervals_; ++p) {
      std::fill(next.begin() + long(stale.first), next.begin() + long(stale.last) + 1, kFar);
      const Range range = rangeOf(p, start);
      for (size_t at = range.first; at <= range.last; ++at) {
        uint32_t& step = taken[p * row + (at - rowStart(p, start))];
        for (size_t s = min_step_; s <= max_step_ && s <= at; ++s) {
          if (cost[at - s] == kFar) continue;
          const double through = cost[at - s] + pace_cost_[s];
          if (through < next[at]) {
            next[at] = through;
            step = uint32_t(s);
          }
        }
        // After the last phase of a loop, the first follows.
        if (next[at] < kFar && p < phases_) next[at] += distance(p, start + long(at));
      }
      cost.swap(next);
      stale = known;
      known = range.first <= range.last ? range : Range{0, 0};
    }
    steps.assign(phases_, 0);
    if (cost[total_] == kFar) return kFar;
    size_t at = total_;
    for (size_t p = intervals_; p > 0; --p) {
      if (p < phases_) steps[p] = at;
      at -= taken[p * row + (at - rowStart(p, start))];
    }
    return cost[total_];
  }

 private:
  struct Range {
    size_t first, last;  // steps since the start; empty where first > last
  };
  // Step of the first column of a phase's row, since the start.
  size_t rowStart(size_t p, long start) const { return band_.whole() ? 0 : size_t(std::max(0l, bandStart(p) - start)); }
  long bandStart(size_t p) const { return p < phases_ ? band_.first[p] : band_.first[0] + long(total_); }
  Range rangeOf(size_t p, long start) const {
    Range out{p * min_step_, std::min(total_ - std::min(total_, (intervals_ - p) * min_step_), p * max_step_)};
    if (band_.whole()) return out;
    const long last = bandStart(p) + long(band_.width) - 1 - start;
    if (last < 0) return {1, 0};
    return {std::max(out.first, rowStart(p, start)), std::min(out.last, size_t(last))};
  }

  // The member's features at a step.
  void poseAt(const PoseFeatures& member, long step, std::vector<float>& pose) const {
    const long last = long(total_);
    const auto c = size_t(loop_ ? long(wrapped(step, total_)) : std::clamp(step, 0l, last));
    const size_t frame = c / size_t(steps_a_frame_);
    const float share = float(c % size_t(steps_a_frame_)) / float(steps_a_frame_);
    const auto& a = member[frame];
    const auto& b = member[loop_ ? (frame + 1) % frames_ : std::min(frame + 1, frames_ - 1)];
    for (size_t i = 0; i < pose.size(); ++i) pose[i] = a[i] + share * (b[i] - a[i]);
  }
  static float between(const std::vector<float>& a, const std::vector<float>& b) {
    float sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum;
  }

  void measure(const PoseFeatures& reference, const PoseFeatures& member) {
    const size_t columns = loop_ ? total_ : total_ + 1;
    distances_.assign(phases_ * columns, 0);
    std::vector<float> pose(reference[0].size());
    for (size_t c = 0; c < columns; ++c) {
      poseAt(member, long(c), pose);
      for (size_t p = 0; p < phases_; ++p) {
        distances_[p * columns + c] = between(pose, reference[p]);
        mean_ += distances_[p * columns + c];
      }
    }
    mean_ /= double(distances_.size());
  }
  void measureBand(const PoseFeatures& reference, const PoseFeatures& member) {
    mean_ = band_.mean;
    distances_.assign(phases_ * band_.width, 0);
    std::vector<float> pose(reference[0].size());
    for (size_t p = 0; p < phases_; ++p) {
      for (size_t c = 0; c < band_.width; ++c) {
        poseAt(member, band_.first[p] + long(c), pose);
        distances_[p * band_.width + c] = between(pose, reference[p]);
      }
    }
  }
  double distance(size_t phase, long step) const {
    if (!band_.whole()) {
      const long column = step - band_.first[phase];
      return column < 0 || column >= long(band_.width) ? kFar : distances_[phase * band_.width + size_t(column)];
    }
    return loop_ ? distances_[phase * total_ + wrapped(step, total_)] : distances_[phase * (total_ + 1) + size_t(step)];
  }

  size_t phases_, frames_, total_ = 0, intervals_ = 0, min_step_ = 1, max_step_ = 1;
  bool loop_;
  Band band_;
  int steps_a_frame_ = 1;
  std::vector<float> distances_;
  std::vector<double> pace_cost_;  // [step]
  double mean_ = 0;
};

// Finds the start of the cheapest cyclic path among `count` steps from `first` on: by a coarse scan, then by halving
// the interval round the best. A scan of the whole loop is cyclic.
long bestStart(const Grid& grid, long first, size_t count) {
  std::vector<size_t> steps;
  size_t stride = std::max<size_t>(1, count / kCoarseStarts);
  long best = first;
  double least = kFar;
  const bool around = count == grid.positions();
  const auto consider = [&](long start) {
    if (around) start = long(wrapped(start, count));
    const double cost = grid.path(start, steps);
    if (cost < least) {
      least = cost;
      best = start;
    }
  };
  for (size_t start = 0; start < count; start += stride) consider(first + long(start));
  while (stride > 1) {
    stride = (stride + 1) / 2;
    const long centre = best;
    consider(centre - long(stride));
    consider(centre + long(stride));
  }
  return best;
}

struct Warp {
  std::vector<double> time;  // [phase] frames of the member
  double mean = 0;           // distance of phases to steps
};

Warp warpOf(const Grid& grid, long start, const std::vector<size_t>& steps) {
  Warp out{{}, grid.meanDistance()};
  for (const size_t step : steps) out.time.push_back(double(start + long(step)) / grid.stepsAFrame());
  return out;
}

Warp warpWhole(const PoseFeatures& reference, const PoseFeatures& member, bool loop) {
  const Grid grid(reference, member, loop);
  const long start = loop ? bestStart(grid, 0, grid.positions()) : 0;
  std::vector<size_t> steps;
  grid.path(start, steps);
  return warpOf(grid, start, steps);
}

// Selects `count` features at equal intervals; of a motion that is no loop, the first and the last are among them.
PoseFeatures thinned(const PoseFeatures& features, size_t count, bool loop) {
  if (count >= features.size()) return features;
  PoseFeatures out;
  const double interval =
      loop ? double(features.size()) / double(count) : double(features.size() - 1) / double(count - 1);
  for (size_t i = 0; i < count; ++i) out.push_back(features[size_t(std::lround(double(i) * interval))]);
  return out;
}

// Number of intervals between the features, including a loop's closing one.
double intervalsOf(size_t count, bool loop) { return double(loop ? count : count - 1); }

// Upsamples a warp of thinned features to all phases, in steps of the finer grid.
std::vector<double> refined(const Warp& coarse, size_t thin_frames, size_t phases, size_t frames, bool loop) {
  const double phase_scale = intervalsOf(coarse.time.size(), loop) / intervalsOf(phases, loop);
  const double step_scale =
      intervalsOf(frames, loop) / intervalsOf(thin_frames, loop) * Grid::stepsAFrame(phases, frames);
  std::vector<double> out;
  for (size_t p = 0; p < phases; ++p) {
    const double at = double(p) * phase_scale;
    const auto before = std::min(size_t(at), coarse.time.size() - 1);
    const double from = coarse.time[before];
    const double to = before + 1 < coarse.time.size() ? coarse.time[before + 1]
                      : loop                          ? coarse.time[0] + double(thin_frames)
                                                      : from;
    out.push_back(step_scale * (from + (at - double(before)) * (to - from)));
  }
  return out;
}

// Range of a loop's starts that are tried in a band: the middle half of its first row.
long firstStart(const Band& band) { return band.first[0] + long(band.width / 4); }
size_t startCount(const Band& band) { return std::max<size_t>(1, band.width / 2); }

// False if a path touches an edge of its band or of the range of starts: a cheaper one may lie beyond.
bool keepsInside(const Band& band, long start, const std::vector<size_t>& steps, size_t total, bool loop) {
  if (loop && (start <= firstStart(band) || start + 1 >= firstStart(band) + long(startCount(band)))) return false;
  for (size_t p = 1; p < steps.size(); ++p) {
    const long at = start + long(steps[p]), last = band.first[p] + long(band.width) - 1;
    const bool first_edge = at <= band.first[p] && (loop || at > 0);
    const bool last_edge = at >= last && (loop || at < long(total));
    if (first_edge || last_edge) return false;
  }
  return true;
}

// Warps thinned motions first, then all phases in a band round that path; widens the band while the path touches its
// edge.
Warp warpInBand(const PoseFeatures& reference, const PoseFeatures& member, bool loop, const WarpSearch& search) {
  const size_t phases = reference.size(), frames = member.size();
  const auto side = std::max<size_t>(8, size_t(std::sqrt(double(search.max_cells) / (2 * kStepsAPhase))));
  const size_t thin_phases = std::min(phases, side), thin_frames = std::min(frames, side);
  const Warp coarse = warpWhole(thinned(reference, thin_phases, loop), thinned(member, thin_frames, loop), loop);
  const std::vector<double> centre = refined(coarse, thin_frames, phases, frames, loop);
  const double frame_steps =
      intervalsOf(frames, loop) / intervalsOf(thin_frames, loop) * Grid::stepsAFrame(phases, frames);
  // Half widths: of the widest band that the cells allow, and of the first band.
  const size_t most = std::max<size_t>(1, search.max_cells / phases / 2);
  auto half = std::clamp<size_t>(size_t(std::ceil(search.band_frames * frame_steps)), 1, most);
  for (;;) {
    Band band{{}, 2 * half + 1, coarse.mean};
    for (const double c : centre) band.first.push_back(std::lround(c) - long(half));
    const Grid grid(reference, member, loop, band);
    const long start = loop ? bestStart(grid, firstStart(band), startCount(band)) : 0;
    std::vector<size_t> steps;
    const bool found = grid.path(start, steps) < kFar;
    const bool widest = half == most || band.width > grid.positions();
    if (!found && widest) {  // at the pace of the thinned motions
      Warp out{{}, coarse.mean};
      for (const double c : centre) out.time.push_back(c / grid.stepsAFrame());
      return out;
    }
    if (found && (widest || keepsInside(band, start, steps, grid.positions(), loop))) return warpOf(grid, start, steps);
    half = std::min(2 * half, most);
  }
}

// Smooths a path by averaging neighbours' deviations from the mean pace, which keeps paces within their bounds. A
// path that is no loop is mirrored at its ends, which stay fixed.
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

std::vector<double> warpTime(const PoseFeatures& reference, const PoseFeatures& member, bool loop,
                             const WarpSearch& search) {
  if (reference.size() < 2 || member.size() < 2) return std::vector<double>(reference.size(), 0);
  const size_t steps = member.size() * size_t(Grid::stepsAFrame(reference.size(), member.size()));
  std::vector<double> time =
      (reference.size() * steps <= search.max_cells ? warpWhole(reference, member, loop)
                                                    : warpInBand(reference, member, loop, search))
          .time;
  const double pass = double(member.size());
  smooth(time, pass, loop);
  if (const double turns = loop ? std::floor(time[0] / pass) : 0; turns != 0)
    for (double& t : time) t -= turns * pass;
  return time;
}

}  // namespace fourdvt::bake

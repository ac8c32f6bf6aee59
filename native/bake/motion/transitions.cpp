// SPDX-License-Identifier: Apache-2.0
// Every sum of s(a,b) over vertices is a product of two feature rows, so that all pairs are a few matrix products:
// with a and b centred over the ground, min over yaw of Σ |a - T b|² = Σ|a|² + Σ|b|² - 2 (√(C² + S²) + H).
// The poses are fitted half way through the cross-fade, where both weigh the same.
#include "bake/motion/transitions.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "bake/motion/time_warp.h"
#include "base/parallel.h"
#include "motion/motion_graph.h"
#include "motion/placement.h"

namespace fourdvt::bake {
namespace {

// Sums are double, because small distances are differences of large sums.
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Pictures = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kEntryShare =
    0.25;  // a state that does not loop is entered within this first share, so that its motion is visible

// Feature matrix with one row per sample (weight row and frame of a state): positions, then velocities times √λ_v.
struct Features {
  Matrix ground;  // x and z of all values, centred
  Matrix turned;  // z and -x of the same, for S as `ground` is for C
  Matrix height;
  Pictures picture;  // tiny atlas, 0…1; no columns without one
  Eigen::VectorXd squares;
  Eigen::VectorXf picture_squares;
  std::vector<glm::dvec2> centre;
  std::vector<MotionPath> paths;  // [weight row]
  Steps steps;                    // the largest steps of all paths
};

std::vector<glm::vec3> chosen(const Positions& positions, const std::vector<uint32_t>& vertices) {
  std::vector<glm::vec3> out;
  for (uint32_t v : vertices) out.push_back(positions[v]);
  return out;
}

// [frame] root motion to the next frame, in the character's frame; the last frame of a pass continues the one before.
std::vector<glm::vec3> rootSteps(const TransitionState& state, uint32_t row) {
  std::vector<glm::vec3> steps;
  for (uint32_t t = 0; t + 1 < state.frame_count; ++t)
    steps.push_back(motion::stepBetween(state.root(row, t), state.root(row, t + 1)));
  steps.push_back(steps.empty() ? glm::vec3(0) : steps.back());
  return steps;
}

// Velocities over the ground at one frame: the pose's own, by differences, plus root motion.
std::vector<glm::vec3> velocities(const MotionPath& path, uint32_t t) {
  const uint32_t count = uint32_t(path.positions.size());
  const uint32_t before = t > 0 ? t - 1 : path.loop ? count - 1 : 0;
  const uint32_t after = t + 1 < count ? t + 1 : path.loop ? 0 : t;
  const float frames = path.loop ? 2.f : float(std::max(after - before, 1u));
  const glm::vec3 step = 0.5f * (path.root_steps[t > 0 ? t - 1 : 0] + path.root_steps[t]);
  std::vector<glm::vec3> out;
  for (size_t v = 0; v < path.positions[t].size(); ++v) {
    const glm::vec3& p = path.positions[t][v];
    const glm::vec3 own = (path.positions[after][v] - path.positions[before][v]) / frames;
    const glm::vec3 carried(step.x + step.z * p.z, 0, step.y - step.z * p.x);
    out.push_back(float(path.frames_per_s) * (own + carried));
  }
  return out;
}

void fillRow(const Positions& positions, const std::vector<glm::vec3>& velocities, Eigen::Index row,
             Features& features) {
  const Eigen::Index count = features.height.cols() / 2;
  glm::dvec2 centre(0);
  for (Eigen::Index v = 0; v < count; ++v)
    centre += glm::dvec2(positions[size_t(v)].x, positions[size_t(v)].z) / double(count);
  features.centre.push_back(centre);
  const auto put = [&](Eigen::Index v, float x, float y, float z) {
    features.ground(row, v) = x;
    features.ground(row, 2 * count + v) = z;
    features.turned(row, v) = z;
    features.turned(row, 2 * count + v) = -x;
    features.height(row, v) = y;
  };
  for (Eigen::Index v = 0; v < count; ++v) {
    const glm::vec3& p = positions[size_t(v)];
    const glm::vec3& velocity = velocities[size_t(v)];
    put(v, p.x - float(centre.x), p.y, p.z - float(centre.y));
    put(count + v, velocity.x, velocity.y, velocity.z);
  }
}

Status fillPicture(const Image& image, int side, Eigen::Index row, Features& features) {
  const int colours = std::min(image.channels, 3);
  if (image.width != side || image.height != side || colours < 3)
    return Error{ErrorId::Internal, "motion graph: an atlas has another size than the others"};
  if (features.picture.cols() == 0) features.picture.setZero(features.ground.rows(), 3 * side * side);
  for (int i = 0; i < side * side; ++i)
    for (int c = 0; c < 3; ++c)
      features.picture(row, 3 * i + c) = float(image.pixels[size_t(i * image.channels + c)]) / 255;
  return {};
}

using KeepOn = std::function<bool()>;  // false: stop

Error interrupted() { return {ErrorId::Interrupted, "stopped while measuring transitions"}; }

// `vertices`: first those compared by the fit, then those used by the steps only.
Result<Features> featuresOf(const TransitionState& state, const std::vector<uint32_t>& vertices,
                            const TransitionOptions& options, const KeepOn& keep_on) {
  Features features;
  const Eigen::Index rows = Eigen::Index(state.weight_rows.size() * state.frame_count);
  const Eigen::Index count = Eigen::Index(std::min(vertices.size(), size_t(options.features)));
  features.ground.resize(rows, 4 * count);
  features.turned.resize(rows, 4 * count);
  features.height.resize(rows, 2 * count);
  for (uint32_t r = 0; r < state.weight_rows.size(); ++r) {
    MotionPath path{state.frames_per_s[r], state.loop, {}, rootSteps(state, r), {}};
    for (uint32_t t = 0; t < state.frame_count; ++t) {
      if (!keep_on()) return interrupted();
      FOURDVT_ASSIGN(auto positions, state.positions(r, t));
      path.positions.push_back(chosen(positions, vertices));
    }
    for (uint32_t t = 0; t < state.frame_count; ++t) {
      const Eigen::Index row = Eigen::Index(r * state.frame_count + t);
      std::vector<glm::vec3> scaled = velocities(path, t);
      for (glm::vec3& v : scaled) v *= std::sqrt(float(options.velocity_weight));
      fillRow(path.positions[t], scaled, row, features);
      if (!state.atlas) continue;
      FOURDVT_ASSIGN(const Image atlas, state.atlas(r, t));
      FOURDVT_TRY(fillPicture(atlas, options.atlas, row, features));
    }
    path.steps = ownSteps(path, options.pop.tick_s);
    for (const Steps& steps : path.steps) features.steps = larger(features.steps, steps);
    features.paths.push_back(std::move(path));
  }
  features.squares = features.ground.rowwise().squaredNorm() + features.height.rowwise().squaredNorm();
  features.picture_squares = features.picture.rowwise().squaredNorm();
  return features;
}

glm::vec3 shiftOf(double c, double s, const glm::dvec2& source, const glm::dvec2& target) {
  const float yaw = float(std::atan2(s, c));
  const glm::vec2 moved = motion::moved({glm::vec2(0), yaw}, {glm::vec2(target), 0}).ground_m;
  return {glm::vec2(source) - moved, yaw};
}

// Exit of the source and entry of the target, as rows of their features.
struct TransitionCandidate {
  motion::Entry entry;                            // without its shift and the cost of its pop
  Eigen::Index source_half = 0, target_half = 0;  // rows half way through the fade
};

// All transitions from one state to another.
class Pair {
 public:
  Pair(const TransitionState& from, const Features& source, const TransitionState& to, const Features& target,
       const TransitionOptions& options);
  Result<std::vector<motion::Entry>> entries(const KeepOn& keep_on) const;  // one per sample of the source

 private:
  void addCandidates(uint32_t row, uint32_t frame, uint32_t target_row, double fade_s,
                     std::vector<TransitionCandidate>& out) const;
  motion::Entry best(uint32_t row, uint32_t frame) const;
  glm::vec3 shift(const TransitionCandidate& candidate) const;

  const TransitionState &from_, &to_;
  const Features &source_, &target_;
  const TransitionOptions& options_;
  const Matrix c_, s_;
  Matrix fit_;  // residual of the fit, millimetres
  const Steps own_;
};

Pair::Pair(const TransitionState& from, const Features& source, const TransitionState& to, const Features& target,
           const TransitionOptions& options)
    : from_(from),
      to_(to),
      source_(source),
      target_(target),
      options_(options),
      c_(source.ground * target.ground.transpose()),
      s_(source.ground * target.turned.transpose()),
      fit_(source.height * target.height.transpose()),
      own_(larger(source.steps, target.steps)) {
  const bool pictures = source.picture.cols() > 0 && target.picture.cols() == source.picture.cols();
  const Pictures p = pictures ? Pictures(source.picture * target.picture.transpose()) : Pictures();
  const double vertices = double(source.height.cols()) / 2;
  for (Eigen::Index a = 0; a < c_.rows(); ++a) {
    for (Eigen::Index b = 0; b < c_.cols(); ++b) {
      const double turned = std::hypot(c_(a, b), s_(a, b)) + fit_(a, b);
      fit_(a, b) = 1000 * std::sqrt(std::max(0.0, source.squares(a) + target.squares(b) - 2 * turned) / vertices);
      if (!pictures) continue;
      const float apart = std::max(0.f, source.picture_squares(a) + target.picture_squares(b) - 2 * p(a, b));
      fit_(a, b) += options.appearance_mm * std::sqrt(apart / float(source.picture.cols()));
    }
  }
}

void Pair::addCandidates(uint32_t row, uint32_t frame, uint32_t target_row, double fade_s,
                         std::vector<TransitionCandidate>& out) const {
  const double rate = source_.paths[row].frames_per_s, target_rate = target_.paths[target_row].frames_per_s;
  const uint32_t last = to_.frame_count - 1, source_last = from_.frame_count - 1;
  uint32_t fade = std::max(1u, uint32_t(std::lround(fade_s * target_rate)));
  if (!to_.loop) fade = std::clamp(last, 1u, fade);
  const uint32_t half = fade / 2, source_half = frame + uint32_t(std::lround(half * rate / target_rate));
  // Motions that end are entered early, so that their beginning is seen, and left early, so that they never stand
  // still.
  const uint32_t seen = uint32_t(kEntryShare * to_.frame_count);
  const uint32_t newest = to_.loop ? last : std::min(last - std::min(last, fade), seen > half ? seen - half : 0);
  const double over = from_.loop ? 0 : frame + fade * rate / target_rate - source_last;
  const double price = options_.fade_cost_mm_per_s * std::max(0.0, fade / target_rate - options_.fades_s.front()) +
                       options_.hold_cost_mm_per_s * std::max(0.0, over) / rate;
  TransitionCandidate candidate;
  const uint32_t source_frame = from_.loop ? source_half % from_.frame_count : std::min(source_half, source_last);
  candidate.source_half = row * from_.frame_count + source_frame;
  for (uint32_t entered = 0; entered <= newest; ++entered) {
    const uint32_t target_frame = to_.loop ? (entered + half) % to_.frame_count : std::min(entered + half, last);
    candidate.target_half = target_row * to_.frame_count + target_frame;
    const double cost = fit_(candidate.source_half, candidate.target_half) + price;
    candidate.entry = {entered, target_row, fade, float(cost), glm::vec3(0)};
    out.push_back(candidate);
  }
}

glm::vec3 Pair::shift(const TransitionCandidate& candidate) const {
  const Eigen::Index a = candidate.source_half, b = candidate.target_half;
  return shiftOf(c_(a, b), s_(a, b), source_.centre[size_t(a)], target_.centre[size_t(b)]);
}

// The entry of minimum cost. Pops are computed only for candidates that may still be the best.
motion::Entry Pair::best(uint32_t row, uint32_t frame) const {
  std::vector<TransitionCandidate> all;
  for (uint32_t target_row = 0; target_row < target_.paths.size(); ++target_row)
    for (const double fade_s : options_.fades_s) addCandidates(row, frame, target_row, fade_s, all);
  std::stable_sort(all.begin(), all.end(), [](const TransitionCandidate& a, const TransitionCandidate& b) {
    return a.entry.cost < b.entry.cost;
  });
  motion::Entry best;
  best.cost = 1e30f;
  for (const TransitionCandidate& candidate : all) {
    if (candidate.entry.cost >= best.cost) break;
    motion::Entry entry = candidate.entry;
    entry.shift = shift(candidate);
    const double enough = options_.max_pop + (best.cost - entry.cost) / options_.pop_cost_mm;
    const double pop = popOf(source_.paths[row], target_.paths[entry.weight_row],
                             {frame, entry.frame, entry.fade_frames, entry.shift}, {own_, enough}, options_.pop);
    entry.cost += float(options_.pop_cost_mm * std::max(0.0, pop - options_.max_pop));
    if (entry.cost < best.cost) best = entry;
  }
  return best;
}

Result<std::vector<motion::Entry>> Pair::entries(const KeepOn& keep_on) const {
  std::vector<motion::Entry> out(source_.paths.size() * from_.frame_count);
  for (uint32_t row = 0; row < source_.paths.size(); ++row) {
    for (uint32_t frame = 0; frame < from_.frame_count; ++frame)
      if (!keep_on()) return interrupted();
    inParallel(from_.frame_count, [&](uint32_t frame) { out[row * from_.frame_count + frame] = best(row, frame); });
  }
  return out;
}

}  // namespace

Result<std::vector<uint8_t>> buildMotionGraph(const std::vector<TransitionState>& states,
                                              const TransitionOptions& options,
                                              const std::function<bool(double)>& progress) {
  std::vector<motion::GraphState> described;
  std::vector<std::vector<motion::Entry>> tables(states.size() * states.size());
  if (states.empty()) return motion::writeMotionGraph(described, tables);
  FOURDVT_ASSIGN(auto pose, states[0].positions(0, 0));
  size_t samples = 0, done = 0;
  for (const TransitionState& state : states) samples += state.weight_rows.size() * state.frame_count;
  const int64_t affordable = options.step_bytes / int64_t(std::max<size_t>(samples, 1) * sizeof(glm::vec3));
  const std::vector<uint32_t> vertices = spreadVertices(
      pose, size_t(std::max(int64_t(options.features), std::min(int64_t(options.step_features), affordable))));
  // Every sample is measured once and then compared with every other state.
  const KeepOn keep_on = [&] { return progress(double(done++) / double(samples * states.size())); };
  std::vector<Features> features;
  for (const TransitionState& state : states) {
    FOURDVT_ASSIGN(auto measured, featuresOf(state, vertices, options, keep_on));
    features.push_back(std::move(measured));
    described.push_back({state.frame_count, state.weight_rows});
  }
  for (size_t t = 0; t < tables.size(); ++t) {
    const size_t source = t / states.size(), target = t % states.size();
    if (source == target) continue;
    FOURDVT_ASSIGN(tables[t],
                   Pair(states[source], features[source], states[target], features[target], options).entries(keep_on));
  }
  return motion::writeMotionGraph(described, tables);
}

namespace {

using motion::moved;
using motion::Placement;

constexpr double kRounding = 1e-6;
constexpr double kStill_m = 0.002;  // lower bound of the step length, for motions that hardly move

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

// Clamps a motion that does not loop to its last frame.
uint32_t frameAt(const MotionPath& path, int64_t frame) {
  const int64_t count = int64_t(path.positions.size());
  return uint32_t(path.loop ? (frame % count + count) % count : std::clamp<int64_t>(frame, 0, count - 1));
}

// Maximum number of frames between two ticks.
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

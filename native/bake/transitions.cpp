// SPDX-License-Identifier: Apache-2.0
// Every sum of s(a,b) over vertices is a product of two feature rows, so that all pairs are a few matrix products:
// with a and b centred over the ground, min over yaw of Σ |a - T b|² = Σ|a|² + Σ|b|² - 2 (√(C² + S²) + H).
#include "bake/transitions.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "bake/time_warp.h"
#include "motion/motion_graph.h"
#include "motion/placement.h"

namespace fourdvt::bake {
namespace {

// Double: small distances are differences of large sums.
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Pictures = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kEntryShare = 0.25;  // of a state that does not loop: entered in this first part, so that it is seen

// A row a sample: weight row × frame of a state. Positions, then velocities times √λ_v.
struct Features {
  Matrix ground;  // x and z of all, centred
  Matrix turned;  // z and -x of the same: what C becomes S with
  Matrix height;
  Pictures picture;  // tiny atlas 0..1; no columns without
  Eigen::VectorXd squares;
  Eigen::VectorXf picture_squares;
  std::vector<glm::dvec2> centre;
};

struct Sample {  // one pose
  std::vector<glm::vec3> positions, velocities;
};

std::vector<glm::vec3> chosen(const Positions& positions, const std::vector<uint32_t>& vertices) {
  std::vector<glm::vec3> out;
  for (uint32_t v : vertices) out.push_back(positions[v]);
  return out;
}

// The ground's share of velocity: root motion from one frame to another, in the character's frame, a frame.
glm::vec3 rootStep(const TransitionState& state, uint32_t row, uint32_t frame) {
  if (state.frame_count < 2) return glm::vec3(0);
  const uint32_t from = frame > 0 ? frame - 1 : 0, to = std::min(frame + 1, state.frame_count - 1);
  return motion::stepBetween(state.root(row, from), state.root(row, to)) / float(to - from);
}

// Velocities over the ground: the pose's own by differences, plus root motion.
void addVelocities(const TransitionState& state, uint32_t row, std::vector<Sample>& samples) {
  const uint32_t count = state.frame_count;
  for (uint32_t t = 0; t < count; ++t) {
    const uint32_t before = t > 0 ? t - 1 : state.loop ? count - 1 : 0;
    const uint32_t after = t + 1 < count ? t + 1 : state.loop ? 0 : t;
    const float frames = state.loop ? 2.f : float(std::max(after - before, 1u));
    const glm::vec3 step = rootStep(state, row, t);
    for (size_t v = 0; v < samples[t].positions.size(); ++v) {
      const glm::vec3& p = samples[t].positions[v];
      const glm::vec3 own = (samples[after].positions[v] - samples[before].positions[v]) / frames;
      const glm::vec3 carried(step.x + step.z * p.z, 0, step.y - step.z * p.x);
      samples[t].velocities.push_back(float(state.fps) * (own + carried));
    }
  }
}

void fillRow(const Sample& sample, float velocity_scale, Eigen::Index row, Features& features) {
  const Eigen::Index count = Eigen::Index(sample.positions.size());
  glm::dvec2 centre(0);
  for (const glm::vec3& p : sample.positions) centre += glm::dvec2(p.x, p.z) / double(count);
  features.centre.push_back(centre);
  const auto put = [&](Eigen::Index v, float x, float y, float z) {
    features.ground(row, v) = x;
    features.ground(row, 2 * count + v) = z;
    features.turned(row, v) = z;
    features.turned(row, 2 * count + v) = -x;
    features.height(row, v) = y;
  };
  for (Eigen::Index v = 0; v < count; ++v) {
    const glm::vec3& p = sample.positions[size_t(v)];
    const glm::vec3 velocity = velocity_scale * sample.velocities[size_t(v)];
    put(v, p.x - float(centre.x), p.y, p.z - float(centre.y));
    put(count + v, velocity.x, velocity.y, velocity.z);
  }
}

Status fillPicture(const TransitionState& state, uint32_t weight_row, uint32_t frame, int side, Eigen::Index row,
                   Features& features) {
  if (!state.atlas) return {};
  auto atlas = state.atlas(weight_row, frame);
  if (!atlas) return atlas.error();
  const Image& image = atlas.value();
  const int colours = std::min(image.channels, 3);
  if (image.width != side || image.height != side || colours < 3)
    return Error{ErrorId::Internal, "motion graph: an atlas of another size"};
  if (features.picture.cols() == 0) features.picture.setZero(features.ground.rows(), 3 * side * side);
  for (int i = 0; i < side * side; ++i)
    for (int c = 0; c < 3; ++c)
      features.picture(row, 3 * i + c) = float(image.pixels[size_t(i * image.channels + c)]) / 255;
  return {};
}

using KeepOn = std::function<bool()>;  // false: stop

Result<Features> featuresOf(const TransitionState& state, const std::vector<uint32_t>& vertices,
                            const TransitionOptions& options, const KeepOn& keep_on) {
  Features features;
  const Eigen::Index rows = Eigen::Index(state.weight_rows.size() * state.frame_count);
  const Eigen::Index count = Eigen::Index(vertices.size());
  features.ground.resize(rows, 4 * count);
  features.turned.resize(rows, 4 * count);
  features.height.resize(rows, 2 * count);
  for (uint32_t r = 0; r < state.weight_rows.size(); ++r) {
    std::vector<Sample> samples(state.frame_count);
    for (uint32_t t = 0; t < state.frame_count; ++t) {
      if (!keep_on()) return Error{ErrorId::Interrupted, "stopped while measuring transitions"};
      auto positions = state.positions(r, t);
      if (!positions) return positions.error();
      samples[t].positions = chosen(positions.value(), vertices);
    }
    addVelocities(state, r, samples);
    for (uint32_t t = 0; t < state.frame_count; ++t) {
      const Eigen::Index row = Eigen::Index(r * state.frame_count + t);
      fillRow(samples[t], std::sqrt(float(options.velocity_weight)), row, features);
      FOURDVT_TRY(fillPicture(state, r, t, options.atlas, row, features));
    }
  }
  features.squares = features.ground.rowwise().squaredNorm() + features.height.rowwise().squaredNorm();
  features.picture_squares = features.picture.rowwise().squaredNorm();
  return features;
}

// Frames of a state that may be entered.
std::pair<uint32_t, uint32_t> entryFrames(const TransitionState& state, const TransitionOptions& options) {
  if (state.loop) return {0, state.frame_count - 1};
  const uint32_t last = state.frame_count - 1, room = std::min(uint32_t(options.fade_frames) / 2, last / 2);
  const uint32_t seen = uint32_t(kEntryShare * state.frame_count);
  return {room, std::max(room, std::min(seen, last - room))};
}

glm::vec3 shiftOf(double c, double s, const glm::dvec2& source, const glm::dvec2& target) {
  const float yaw = float(std::atan2(s, c));
  const glm::vec2 moved = motion::moved({glm::vec2(0), yaw}, {glm::vec2(target), 0}).ground_m;
  return {glm::vec2(source) - moved, yaw};
}

// One row a sample of the source.
std::vector<motion::Entry> bestEntries(const Features& source, const Features& target, const TransitionState& state,
                                       size_t vertices, const TransitionOptions& options) {
  const Matrix c = source.ground * target.ground.transpose();
  const Matrix s = source.ground * target.turned.transpose();
  const Matrix h = source.height * target.height.transpose();
  const bool pictures = source.picture.cols() > 0 && target.picture.cols() == source.picture.cols();
  const Pictures p = pictures ? Pictures(source.picture * target.picture.transpose()) : Pictures();
  const auto [first, last] = entryFrames(state, options);
  std::vector<motion::Entry> entries;
  for (Eigen::Index a = 0; a < c.rows(); ++a) {
    motion::Entry best;
    Eigen::Index best_sample = 0;
    best.cost = 1e30f;
    for (Eigen::Index b = 0; b < c.cols(); ++b) {
      const uint32_t frame = uint32_t(b) % state.frame_count;
      if (frame < first || frame > last) continue;
      const double turned = std::hypot(c(a, b), s(a, b)) + h(a, b);
      const double shape = std::max(0.0, source.squares(a) + target.squares(b) - 2 * turned) / double(vertices);
      float cost = float(1000 * std::sqrt(shape));
      if (pictures) {
        const float apart = std::max(0.f, source.picture_squares(a) + target.picture_squares(b) - 2 * p(a, b));
        cost += float(options.appearance_mm) * std::sqrt(apart / float(source.picture.cols()));
      }
      if (cost >= best.cost) continue;
      best = {frame, uint32_t(b) / state.frame_count, cost, glm::vec3(0)};
      best_sample = b;
    }
    best.shift =
        shiftOf(c(a, best_sample), s(a, best_sample), source.centre[size_t(a)], target.centre[size_t(best_sample)]);
    entries.push_back(best);
  }
  return entries;
}

}  // namespace

Result<std::vector<uint8_t>> buildMotionGraph(const std::vector<TransitionState>& states,
                                              const TransitionOptions& options,
                                              const std::function<bool(double)>& progress) {
  std::vector<motion::GraphState> described;
  std::vector<std::vector<motion::Entry>> tables(states.size() * states.size());
  if (states.empty()) return motion::writeMotionGraph(described, tables);
  auto pose = states[0].positions(0, 0);
  if (!pose) return pose.error();
  const std::vector<uint32_t> vertices = spreadVertices(pose.value(), size_t(options.features));
  size_t samples = 0, done = 0;
  for (const TransitionState& state : states) samples += state.weight_rows.size() * state.frame_count;
  const KeepOn keep_on = [&] { return progress(0.9 * double(done++) / double(samples)); };
  std::vector<Features> features;
  for (const TransitionState& state : states) {
    auto measured = featuresOf(state, vertices, options, keep_on);
    if (!measured) return measured.error();
    features.push_back(measured.take());
    described.push_back({state.frame_count, state.weight_rows});
  }
  for (size_t t = 0; t < tables.size(); ++t) {
    const size_t source = t / states.size(), target = t % states.size();
    if (!progress(0.9 + 0.1 * double(t) / double(tables.size())))
      return Error{ErrorId::Interrupted, "stopped while measuring transitions"};
    if (source == target) continue;
    tables[t] = bestEntries(features[source], features[target], states[target], vertices.size(), options);
  }
  return motion::writeMotionGraph(described, tables);
}

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// A point of the ground is the complex number z + i x, so that a turn is a product.
#include "track/cycle.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>

namespace fourdvt::track {
namespace {

constexpr size_t kCompared = 300;      // vertices that are compared
constexpr double kVelocityFrames = 2;  // weight of a difference in velocity, frames
constexpr double kFloor_m = 1e-4;      // error below which cycles are equally good
constexpr double kAsGood = 1.2;        // factor to the least error up to which a shorter cycle is preferred

using Ground = std::complex<double>;

Ground groundOf(const glm::dvec3& p) { return {p.z, p.x}; }
GroundMotion motionOf(double turn_rad, const Ground& shift) { return {turn_rad, {shift.imag(), shift.real()}}; }

// Least squares of b − motion(a) over pairs of points.
class Alignment {
 public:
  void add(const Positions& a, const Positions& b) {
    for (size_t v = 0; v < a.size(); ++v) {
      const Ground p = groundOf(a[v]), q = groundOf(b[v]);
      from_ += p;
      to_ += q;
      product_ += std::conj(p) * q;
    }
    count_ += double(a.size());
  }
  GroundMotion solve() const {
    const Ground centred = product_ - std::conj(from_) * to_ / count_;
    const double turn = std::abs(centred) > 0 ? std::arg(centred) : 0;
    return motionOf(turn, (to_ - std::polar(1.0, turn) * from_) / count_);
  }

 private:
  Ground from_, to_, product_;
  double count_ = 0;
};

GroundMotion motionBetween(const Positions& a, const Positions& b) {
  Alignment alignment;
  alignment.add(a, b);
  return alignment.solve();
}

// Squares of the difference of all pairs of frames in pose and velocity, up to a motion over the ground. Source: Kovar,
// Gleicher, Pighin: Motion Graphs. ACM Transactions on Graphics 21(3), 2002. Centred poses leave a turn, whose minimum
// is closed: min over yaw of Σ |b − T a|² = Σ |a|² + Σ |b|² − 2 |Σ ā b|.
Eigen::MatrixXd differences(std::span<const Positions> frames) {
  const size_t count = frames.size(), vertices = frames[0].size();
  const size_t stride = std::max<size_t>(1, vertices / kCompared), compared = (vertices + stride - 1) / stride;
  Eigen::MatrixXcd ground(count, 2 * compared);
  Eigen::MatrixXd height(count, 2 * compared);
  // Velocities are central differences, at the clip's ends of the same order.
  const auto velocity = [&](size_t f, size_t v) {
    const size_t at = std::clamp<size_t>(f, 1, count - 2);
    const glm::dvec3 before = frames[at - 1][v], here = frames[at][v], after = frames[at + 1][v];
    return 0.5 * (after - before) + (double(f) - double(at)) * (before - 2.0 * here + after);
  };
  for (size_t f = 0; f < count; ++f) {
    const auto row = Eigen::Index(f);
    for (size_t i = 0; i < compared; ++i) {
      const auto pose = Eigen::Index(i), moving = Eigen::Index(compared + i);
      const glm::dvec3 p = frames[f][i * stride], u = kVelocityFrames * velocity(f, i * stride);
      ground(row, pose) = groundOf(p);
      ground(row, moving) = groundOf(u);
      height(row, pose) = p.y;
      height(row, moving) = u.y;
    }
    auto places = ground.row(row).head(Eigen::Index(compared));
    places.array() -= places.mean();
  }
  const Eigen::MatrixXcd products = ground * ground.adjoint();
  const Eigen::MatrixXd heights = height * height.transpose();
  Eigen::MatrixXd out(count, count);
  for (Eigen::Index a = 0; a < out.rows(); ++a)
    for (Eigen::Index b = 0; b < out.cols(); ++b) {
      const double turned = products(a, a).real() + products(b, b).real() - 2 * std::abs(products(a, b));
      const double raised = heights(a, a) + heights(b, b) - 2 * heights(a, b);
      out(a, b) = std::max(0.0, turned + raised) / double(compared);
    }
  return out;
}

double eased(double x) { return x * x * (3 - 2 * x); }

}  // namespace

std::optional<Cycle> findCycle(std::span<const Positions> frames, uint32_t min_frames, uint32_t max_frames) {
  const uint32_t count = uint32_t(frames.size());
  min_frames = std::max(min_frames, 1u);
  max_frames = std::min(max_frames, count - 1);
  if (count < 3 || min_frames > max_frames) return std::nullopt;
  const Eigen::MatrixXd squares = differences(frames);
  std::vector<Cycle> best(max_frames + 1);  // [length]
  for (uint32_t length = min_frames; length <= max_frames; ++length) best[length].error_share = HUGE_VAL;
  for (uint32_t first = 0; first + min_frames < count; ++first) {
    double changed = 0;
    for (uint32_t last = first + 1; last < count && last <= first + max_frames; ++last) {
      const uint32_t length = last - first;
      const double square = squares(first, last);
      changed += square;
      if (length < min_frames) continue;
      const double floor = kFloor_m * kFloor_m, share = std::sqrt((square + floor) / (changed / length + floor));
      if (share < best[length].error_share) best[length] = {first, last, std::sqrt(square), share, {}};
    }
  }
  const auto shareAt = [&](uint32_t length) {
    return length < min_frames || length > max_frames ? HUGE_VAL : best[length].error_share;
  };
  double least = HUGE_VAL;
  for (uint32_t length = min_frames; length <= max_frames; ++length) least = std::min(least, shareAt(length));
  for (uint32_t length = min_frames; length <= max_frames; ++length) {
    const double share = shareAt(length);
    if (share > kAsGood * least || share > shareAt(length - 1) || share > shareAt(length + 1)) continue;
    Cycle out = best[length];
    out.travel = motionBetween(frames[out.first], frames[out.last]);
    return out;
  }
  return std::nullopt;
}

Loop closeCycle(std::span<const Positions> frames, const Cycle& cycle, uint32_t blend_frames) {
  const uint32_t count = cycle.last - cycle.first, blend = std::min(blend_frames, count - 1);
  const bool before = cycle.first >= blend, after = cycle.last + blend <= frames.size();
  const GroundMotion &travel = cycle.travel, back = shareOf(travel, -1);
  const auto at = [&](uint32_t frame, size_t v) { return glm::dvec3(frames[frame][v]); };
  // Place of a vertex at a frame of the loop: faded into the clip beyond the other end, or with the misfit spread.
  const auto faded = [&](uint32_t f, size_t v) {
    const double beyond = before ? double(f) - double(count - blend - 1) : double(blend) - double(f);
    const glm::dvec3 own = at(cycle.first + f, v);
    if (beyond <= 0) return own;
    const glm::dvec3 other = before ? travel(at(cycle.first + f - count, v)) : back(at(cycle.last + f, v));
    return glm::mix(own, other, eased(beyond / (blend + 1)));
  };
  const auto spread = [&](uint32_t f, size_t v) {
    const glm::dvec3 misfit = back(at(cycle.last, v)) - at(cycle.first, v);
    const double share = double(f) / count;
    const GroundMotion turned{share * travel.turn_rad, glm::dvec2(0)};
    return at(cycle.first + f, v) + (0.5 - share) * turned(misfit);
  };
  Loop loop{std::vector<Positions>(count, Positions(frames[0].size())), travel};
  for (uint32_t f = 0; f < count; ++f)
    for (size_t v = 0; v < frames[0].size(); ++v)
      loop.frames[f][v] = glm::vec3(blend > 0 && (before || after) ? faded(f, v) : spread(f, v));
  return loop;
}

Travel travelOf(const Loop& loop, double fps) {
  const double count = double(loop.frames.size());
  Travel out;
  for (size_t f = 0; f < loop.frames.size(); ++f) {
    glm::dvec3 sum(0);
    for (const glm::vec3& p : loop.frames[f]) sum += glm::dvec3(p);
    out.place_m += shareOf(loop.travel, 0.5 - double(f) / count)(sum / double(loop.frames[f].size())) / count;
  }
  out.velocity_mps = fps / count * velocityAt(loop.travel, out.place_m);
  return out;
}

}  // namespace fourdvt::track

// SPDX-License-Identifier: Apache-2.0
#include "refine/camera_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <map>

#include "base/parallel.h"
#include "base/robust.h"

namespace fourdvt::refine {
namespace {

// 0–2 rotation, 3–5 translation, 6 focal length, 7 uniform offset of the surface, 8 frames.
constexpr int kUnknowns = 9;
using Vector = Eigen::Matrix<double, kUnknowns, 1>;
using Matrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;

// Prior standard deviations of calibrated rigs, in the unknowns' units.
constexpr double kMoveSigma_m = 0.003, kZoomSigma = 0.002, kOffsetSigma_m = 0.005, kFramesSigma = 2;
constexpr double kHullTooLarge = 0.3;  // weight of a hull's point with a "too large" residual
constexpr int kFitRounds = 5;
constexpr size_t kMinPoints = 60, kMinBlocks = 6;

// Motion of a projected point along `direction` per unit of every unknown but the last two.
Vector derivativesOf(const PinholeCamera& camera, const glm::dvec3& p, const glm::dvec2& direction) {
  const glm::dvec2 d(direction.x * camera.fx, direction.y * camera.fy);
  const double zoom = (d.x * p.x + d.y * p.y) / p.z;
  const glm::dvec3 move(d.x / p.z, d.y / p.z, -zoom / p.z);
  const glm::dvec3 turn = glm::cross(p, move);  // a rotation vector ω moves p by ω × p
  Vector row;
  row << turn.x, turn.y, turn.z, move.x, move.y, move.z, zoom, 0, 0;
  return row;
}

struct Normal {
  Matrix left = Matrix::Zero();
  Vector right = Vector::Zero();
};

}  // namespace

PinholeCamera changed(const PinholeCamera& camera, const CameraChange& change) {
  PinholeCamera out = camera;
  const double angle = glm::length(change.turn_rad);
  glm::dmat4 motion(1.0);
  if (angle > 0) motion = glm::rotate(motion, angle, change.turn_rad / angle);
  motion[3] = glm::dvec4(change.move_m, 1);
  out.cam_from_world = motion * camera.cam_from_world;
  out.fx *= std::exp(change.zoom_log);
  out.fy *= std::exp(change.zoom_log);
  return out;
}

CameraStep fitCamera(const PinholeCamera& camera, const PinholeCamera& given, std::span<const BlockedPoint> points,
                     Freedom freedom, SurfaceKind surface) {
  CameraStep out;
  std::map<uint32_t, Normal> blocks;
  for (const BlockedPoint& s : points) blocks[s.block];
  if (points.size() < kMinPoints || blocks.size() < kMinBlocks) return out;
  std::vector<Vector> rows;
  rows.reserve(points.size());
  for (const BlockedPoint& s : points) {
    rows.push_back(derivativesOf(camera, glm::dvec3(s.point.point_in_cam), glm::dvec2(s.point.outward)));
    rows.back()[7] = s.point.pixels_per_metre;
    rows.back()[8] = -s.pixels_per_frame;  // the matte of a later picture has advanced along its motion
  }
  // Change relative to `given`, held near zero by the prior.
  Vector since = Vector::Zero();
  const glm::dvec3 moved = glm::dmat3(camera.cam_from_world) * (given.centreInWorld() - camera.centreInWorld());
  if (freedom.place) since << 0, 0, 0, moved.x, moved.y, moved.z, std::log(camera.fx / given.fx), 0, 0;
  Vector x = Vector::Zero();
  Normal whole;
  std::vector<double> misfit(points.size());
  double scale = 1;
  Matrix prior = Matrix::Zero();
  for (int round = 0; round < kFitRounds; ++round) {
    for (size_t i = 0; i < points.size(); ++i) misfit[i] = points[i].point.residual_pixels - rows[i].dot(x);
    scale = std::max(0.05, robustScale(misfit));
    for (auto& [block, normal] : blocks) normal = {};
    for (size_t i = 0; i < points.size(); ++i) {
      const double share = surface == SurfaceKind::Hull && misfit[i] < 0 ? kHullTooLarge : 1;
      const double w = share * tukeyWeight(misfit[i] / scale);
      Normal& normal = blocks[points[i].block];
      normal.left += w * rows[i] * rows[i].transpose();
      normal.right += w * points[i].point.residual_pixels * rows[i];
    }
    whole = {};
    for (const auto& [block, normal] : blocks) {
      whole.left += normal.left;
      whole.right += normal.right;
    }
    // Points within a block are correlated: a block counts as about one independent measurement with the scale's
    // deviation.
    const double per_block = double(points.size()) / double(blocks.size()) * scale * scale;
    const auto hold = [&](int i, double sigma) { prior(i, i) = per_block / (sigma * sigma); };
    prior = Matrix::Zero();
    constexpr double kFixed = 1e-9;
    for (int i = 0; i < 3 && !freedom.turn; ++i) hold(i, kFixed);
    for (int i = 3; i < 6; ++i) hold(i, freedom.place ? kMoveSigma_m : kFixed);
    hold(6, freedom.place ? kZoomSigma : kFixed);
    hold(7, kOffsetSigma_m);
    hold(8, freedom.time ? kFramesSigma : kFixed);
    whole.right -= prior * since;
    x = (whole.left + prior).ldlt().solve(whole.right);
  }
  out.solvable = x.allFinite();
  if (!out.solvable) return out;
  out.change = {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}, x[6], x[8]};
  Matrix covariance = Matrix::Zero();
  for (const auto& [block, normal] : blocks) {
    const Vector without = (whole.left - normal.left + prior).ldlt().solve(whole.right - normal.right) - x;
    covariance += without * without.transpose();
  }
  covariance *= double(blocks.size() - 1) / double(blocks.size());
  for (int i = 0; i < 3; ++i) out.turn_deviation_rad[i] = std::sqrt(covariance(i, i));
  // A jackknife underestimates the deviation without motion: there only the prior constrains the time.
  const double unknown_share = prior(8, 8) / (prior(8, 8) + whole.left(8, 8));
  out.frames_deviation = std::hypot(std::sqrt(covariance(8, 8)), kFramesSigma * unknown_share);
  double squares = 0;
  for (const BlockedPoint& s : points)
    for (const glm::dvec2 axis : {glm::dvec2(1, 0), glm::dvec2(0, 1)}) {
      Vector row = derivativesOf(camera, glm::dvec3(s.point.point_in_cam), axis);
      squares += row.dot(covariance * row);
    }
  out.shift_deviation_pixels = std::sqrt(squares / double(points.size()));
  return out;
}

double shiftPixels(const PinholeCamera& a, const PinholeCamera& b, std::span<const BlockedPoint> points) {
  const glm::dmat4 b_from_a = b.cam_from_world * glm::inverse(a.cam_from_world);
  double squares = 0;
  for (const BlockedPoint& s : points) {
    const glm::dvec3 p(s.point.point_in_cam), q(b_from_a * glm::dvec4(p, 1));
    const glm::dvec2 shift(b.fx * q.x / q.z + b.cx - a.fx * p.x / p.z - a.cx,
                           b.fy * q.y / q.z + b.cy - a.fy * p.y / p.z - a.cy);
    squares += glm::dot(shift, shift);
  }
  return points.empty() ? 0 : std::sqrt(squares / double(points.size()));
}

namespace {

// Added to standard deviations for errors that a jackknife cannot detect (the surface's errors all round).
constexpr double kUnknownPixels = 0.1;
constexpr double kMorePoints = 1.2;  // alternative criterion: growth of the number of points within reach
constexpr Freedom kTurn{}, kAll{.place = true};
constexpr int kSteps = 10, kWideSteps = 4;
constexpr double kWideRad = 0.026;       // the first steps search the matte's edge within 1.5°
constexpr double kSettledPixels = 0.02;  // a smaller step ends the fit

class Fit {
 public:
  Fit(const PinholeCamera& given, const MeasurePoints& measure, SurfaceKind surface, double deviations)
      : given_(given), measure_(measure), surface_(surface), deviations_(deviations) {}

  // Fits the camera iteratively, starting at `from`; returns `from` where constraints are too few. `last`: receives the
  // last step.
  PinholeCamera fitted(const PinholeCamera& from, Freedom freedom, CameraStep& last) const {
    PinholeCamera best = from;
    const float near = OutlineOptions().reach_pixels, wide = std::max(near, static_cast<float>(kWideRad * from.fx));
    for (int step = 0; step < kSteps; ++step) {
      const auto points = measure_(best, step < kWideSteps && !freedom.place ? wide : near);
      last = fitCamera(best, given_, points, freedom, surface_);
      if (!last.solvable) return from;
      const PinholeCamera next = refine::changed(best, last.change);
      const double shift = shiftPixels(best, next, points);
      best = next;
      if (shift < kSettledPixels) break;
    }
    return best;
  }

  // `out` receives the spreads.
  bool clearlyBetter(const PinholeCamera& from, const PinholeCamera& to, double deviation_pixels,
                     CameraRefit& out) const {
    const float reach = OutlineOptions().reach_pixels;
    const auto before = measure_(from, reach), after = measure_(to, reach);
    const double shift = shiftPixels(to, from, after);
    if (!(shift >= deviations_ * std::hypot(deviation_pixels, kUnknownPixels))) return false;
    std::vector<double> spread[2];
    for (const BlockedPoint& s : before) spread[0].push_back(s.point.residual_pixels);
    for (const BlockedPoint& s : after) spread[1].push_back(s.point.residual_pixels);
    out.spread_before_pixels = robustScale(spread[0]), out.spread_after_pixels = robustScale(spread[1]);
    // With a large error, few edges are within reach.
    return out.spread_after_pixels < out.spread_before_pixels || after.size() > kMorePoints * double(before.size());
  }

  void tell(const PinholeCamera& best, const CameraStep& step, CameraRefit& out) const {
    const auto points = measure_(best, OutlineOptions().reach_pixels);
    out.best = CameraShift{shiftPixels(best, given_, points), step.shift_deviation_pixels};
    out.turn_deviation_deg = step.turn_deviation_rad * kDegrees;
  }

 private:
  const PinholeCamera& given_;
  const MeasurePoints& measure_;
  SurfaceKind surface_;
  double deviations_;
};

}  // namespace

CameraRefit refitCamera(const PinholeCamera& current, const PinholeCamera& given, const MeasurePoints& measure,
                        bool with_place, SurfaceKind surface, double deviations) {
  CameraRefit out{.camera = current};
  const Fit fit(given, measure, surface, deviations);
  CameraStep step;
  const PinholeCamera turned = fit.fitted(current, kTurn, step);
  if (!step.solvable) return out;
  fit.tell(turned, step, out);
  out.changed = fit.clearlyBetter(current, turned, step.shift_deviation_pixels, out);
  if (out.changed) out.camera = turned;
  if (!with_place) return out;
  const PinholeCamera moved = fit.fitted(turned, kAll, step);
  if (!step.solvable || !fit.clearlyBetter(out.camera, moved, step.shift_deviation_pixels, out)) return out;
  out.changed = true;
  out.camera = moved;
  fit.tell(moved, step, out);
  return out;
}

namespace {

constexpr uint32_t kLargestGap = 8;  // frames between two samples
constexpr uint32_t kWindow = 3;      // frames before and after that contribute to a frame's offsets
constexpr double kMinFall = 0.05;    // minimum relative reduction of the other cameras' residuals
constexpr SurfaceFitOptions kOptions{.bound_m = 0.005, .stiffness = 3, .keep = 4, .keep_at_median = false};

uint32_t distance(uint32_t a, uint32_t b, uint32_t loop_frames) {
  const uint32_t straight = a < b ? b - a : a - b;
  return loop_frames > 0 ? std::min(straight, loop_frames - straight) : straight;
}

// [frame][vertex] offsets from the constraints of every `step`-th camera, beginning with the first.
std::vector<std::vector<float>> fitFrom(std::span<const SlowFrame> frames, std::span<const InnerEdge> edges,
                                        size_t vertices, uint32_t loop_frames, size_t step) {
  const std::vector<float> none(vertices);
  std::vector<std::vector<float>> out(frames.size());
  inParallel(frames.size(), [&](int f) {
    std::vector<OffsetClaim> claims;
    for (const SlowFrame& near : frames) {
      if (distance(near.index, frames[size_t(f)].index, loop_frames) > kWindow) continue;
      for (size_t c = 0; c < near.claims.size(); c += step)
        claims.insert(claims.end(), near.claims[c].begin(), near.claims[c].end());
    }
    out[size_t(f)] = fitOffsets(claims, edges, none, {}, kOptions);
  });
  return out;
}

}  // namespace

std::optional<capture::SlowOffsets> fitSlowOffsets(std::span<const SlowFrame> frames, std::span<const InnerEdge> edges,
                                                   size_t vertices, uint32_t loop_frames) {
  if (frames.size() < 3 || frames[0].claims.size() < 2) return std::nullopt;
  for (size_t i = 1; i < frames.size(); ++i)
    if (frames[i].index - frames[i - 1].index > kLargestGap) return std::nullopt;
  const auto half = fitFrom(frames, edges, vertices, loop_frames, 2);
  std::vector<double> without, with;
  for (size_t f = 0; f < frames.size(); ++f)
    for (size_t c = 1; c < frames[f].claims.size(); c += 2)
      for (const OffsetClaim& claim : frames[f].claims[c]) {
        without.push_back(claim.offset_m);
        with.push_back(claim.offset_m - (1 - claim.to_share) * half[f][claim.from] -
                       claim.to_share * half[f][claim.to]);
      }
  if (!(robustScale(with) < (1 - kMinFall) * robustScale(without))) return std::nullopt;
  capture::SlowOffsets out;
  for (const SlowFrame& frame : frames) out.frames.push_back(frame.index);
  out.offset_m = fitFrom(frames, edges, vertices, loop_frames, 1);
  out.loop_frames = loop_frames;
  return out;
}

}  // namespace fourdvt::refine

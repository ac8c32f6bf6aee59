// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/tracker.h"

#include <cmath>

#include "lab/studio/random.h"

namespace fourdvt::studio {
namespace {

constexpr double kTau = 6.28318530717958647692;
constexpr double kDriftWave_m = 0.7, kProxyWave_m = 0.09;
constexpr int kMaxSteps = 40;
constexpr double kAligned_m = 1e-6;

// Smooth function of a point in the rest pose, -1…1; `kind` selects an independent one.
double smoothNoise(const glm::dvec3& p, double wave_m, uint32_t seed, int kind) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const auto normal = [&](int k) { return randomNormal(seed, 0xf1e1d000 + 64 * kind + 8 * i + k); };
    const glm::dvec3 direction = glm::normalize(glm::dvec3(normal(0), normal(1), normal(2)) + 1e-6);
    sum += std::sin(kTau * (glm::dot(p, direction) / wave_m + normal(3)));
  }
  return sum / 3;
}

glm::dvec3 tangentField(const glm::dvec3& p, const glm::dvec3& normal, uint32_t seed) {
  const double a = kTau * smoothNoise(p, kDriftWave_m, seed, 0), b = 0.5 * kTau * smoothNoise(p, kDriftWave_m, seed, 1);
  const glm::dvec3 unit(std::cos(a) * std::cos(b), std::sin(b), std::sin(a) * std::cos(b));
  return unit - glm::dot(unit, normal) * normal;
}

}  // namespace

Tracker::Tracker(const Actor& actor, const StudioKnobs& knobs)
    : knobs_(knobs),
      actor_surface_(actor.surface().topology.face_vertices, actor.surface().positions),
      tracked_surface_(actor.tracked().topology.face_vertices, actor.tracked().positions) {
  for (size_t v = 0; v < tracked_surface_.positions().size(); ++v) {
    const glm::dvec3 p = tracked_surface_.positions()[v], normal = tracked_surface_.normals()[v];
    base_.push_back(actor_surface_.nearest(p));
    drift_.push_back(tangentField(p, normal, knobs.seed));
    offset_.push_back(1e-3 * knobs.proxy_mm * smoothNoise(p, kProxyWave_m, knobs.seed, 2));
  }
}

glm::dvec3 Tracker::driftDirection(uint32_t vertex) const { return drift_[vertex]; }

std::vector<SurfacePoint> Tracker::points(double place, double phase) const {
  std::vector<SurfacePoint> out = base_;
  const double amount = 1e-3 * knobs_.drift_mm * (place - 0.5) * (0.8 + 0.2 * std::cos(kTau * phase));
  if (amount == 0) return out;
  for (size_t v = 0; v < out.size(); ++v) out[v] = actor_surface_.walk(base_[v], amount * drift_[v]);
  return out;
}

Positions Tracker::truth(const std::vector<SurfacePoint>& points, const Positions& pose) const {
  Positions out(points.size());
  for (size_t v = 0; v < points.size(); ++v) out[v] = glm::vec3(actor_surface_.place(points[v], pose));
  return out;
}

Positions Tracker::captured(const std::vector<SurfacePoint>& points, const Positions& pose) const {
  Positions out = truth(points, pose);
  if (knobs_.proxy_mm == 0) return out;
  std::vector<glm::vec3> normals;
  computeVertexNormals(tracked_surface_.faces(), out.data(), out.size(), normals);
  for (size_t v = 0; v < out.size(); ++v) out[v] += static_cast<float>(offset_[v]) * normals[v];
  return out;
}

std::vector<SurfacePoint> Tracker::alignment(double from, double to, double phase) const {
  const Positions& rest = actor_surface_.positions();
  const Positions before = truth(points(from, phase), rest), after = truth(points(to, phase), rest);
  std::vector<SurfacePoint> out(before.size());
  for (uint32_t v = 0; v < out.size(); ++v) out[v] = aligned(v, before[v], after);
  return out;
}

// Walks over the tracked mesh to the point with the given material. `materials`: rest positions under its vertices.
SurfacePoint Tracker::aligned(uint32_t vertex, const glm::dvec3& material, const Positions& materials) const {
  SurfacePoint at = tracked_surface_.atVertex(vertex), best = at;
  double least = 1e9;
  for (int i = 0; i < kMaxSteps; ++i) {
    const glm::dvec3 normal = tracked_surface_.faceNormal(at.face);
    glm::dvec3 missing = material - tracked_surface_.place(at, materials);
    missing -= glm::dot(missing, normal) * normal;
    const double distance = glm::length(missing);
    if (distance < least) least = distance, best = at;
    if (distance < kAligned_m) break;
    at = tracked_surface_.walk(at, (i < kMaxSteps / 2 ? 1.0 : 0.5) * missing);
  }
  return best;
}

}  // namespace fourdvt::studio

// SPDX-License-Identifier: Apache-2.0
#include "bake/labels/face_costs.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace fourdvt::bake {
namespace {

struct CameraAxis {
  glm::dvec3 centre, forward;
  double fx_fy;  // pixels²
};

struct FacePlane {
  glm::dvec3 centre, normal;
};

double rayPenalty(const CameraAxis& camera, const FacePlane& face) {
  const glm::dvec3 ray = face.centre - camera.centre;
  const double length = glm::length(ray);
  return length > 0 ? penalty(face.normal, ray / length) : 1;
}

// Pixels per square metre at the face's centre, for a face frontal to the camera: fx fy d / z³.
double frontalDensity(const CameraAxis& camera, const FacePlane& face) {
  const glm::dvec3 ray = face.centre - camera.centre;
  const double z = glm::dot(ray, camera.forward);
  return z > 0 ? camera.fx_fy * glm::length(ray) / (z * z * z) : 0;
}

double resolutionPenalty(const CameraAxis& camera, const FacePlane& face, double best_density) {
  const glm::dvec3 ray = face.centre - camera.centre;
  const double cosine = -glm::dot(face.normal, ray) / std::max(glm::length(ray), 1e-12);
  if (cosine <= 0 || best_density <= 0) return 1;
  return std::clamp(1 - cosine * frontalDensity(camera, face) / best_density, 0.0, 1.0);
}

// Returns false for a face without area.
bool planeOf(const glm::uvec3& v, const Positions& positions, FacePlane& out) {
  const glm::dvec3 a(positions[v.x]), b(positions[v.y]), c(positions[v.z]);
  const glm::dvec3 area_normal = glm::cross(b - a, c - a);
  const double length = glm::length(area_normal);
  if (length < 1e-14) return false;
  out = {(a + b + c) / 3.0, area_normal / length};
  return true;
}

// Visible fractions of one face in every camera.
struct FaceFractions {
  std::span<const float> all;  // [camera][face]
  size_t face_count, face;
  float of(size_t camera) const { return all[camera * face_count + face]; }
};

// Bit c: camera c lies in front of the face and sees at least `min_fraction` of it.
uint32_t feasibleCameras(std::span<const CameraAxis> cameras, const FacePlane& face, const FaceFractions& fractions,
                         float min_fraction) {
  uint32_t mask = 0;
  for (size_t c = 0; c < cameras.size(); ++c)
    if (fractions.of(c) >= min_fraction && facesCamera(face.normal, face.centre, cameras[c].centre)) mask |= 1u << c;
  return mask;
}

double partialPenalty(double p, double fraction) {
  const double hidden = 1 - fraction;
  return p + (1 - p) * hidden * hidden;
}

}  // namespace

double penalty(const glm::dvec3& normal, const glm::dvec3& optical_axis) {
  const double cosine = glm::dot(normal, optical_axis);
  return 1 - cosine * cosine;
}

bool facesCamera(const glm::dvec3& normal, const glm::dvec3& face_centre, const glm::dvec3& camera_centre) {
  return glm::dot(normal, camera_centre - face_centre) > 0;
}

FaceCosts measureFaceCosts(const FaceCostOptions& options, std::span<const PinholeCamera> cameras,
                           const MeshTopology& topology, const Positions& positions, std::span<const float> fractions) {
  std::vector<CameraAxis> axes;
  for (const PinholeCamera& c : cameras) axes.push_back({c.centreInWorld(), c.middleRayInWorld(), c.fx * c.fy});
  const size_t faces = topology.faceCount(), count = axes.size();
  assert(count <= 32 && fractions.size() == count * faces);
  FaceCosts out{static_cast<int>(count), std::vector<uint32_t>(faces, 0), std::vector<uint32_t>(faces, 0),
                std::vector<uint8_t>(faces, 1), std::vector<float>(faces * count, 1.0f)};
  for (size_t f = 0; f < faces; ++f) {
    FacePlane face;
    if (!planeOf(topology.face_vertices[f], positions, face)) continue;
    const FaceFractions seen{fractions, faces, f};
    const uint32_t full = feasibleCameras(axes, face, seen, options.visible_fraction);
    const uint32_t some = feasibleCameras(axes, face, seen, options.fallback_fraction);
    out.feasible[f] = full ? full : some;
    out.partial[f] = some & ~out.feasible[f];
    out.unseen[f] = some == 0;
    if (!some) std::fill_n(&out.penalty[f * count], count, kUnseenPenalty);
    double best_density = 0;
    if (options.penalty == Penalty::Resolution)
      for (const CameraAxis& axis : axes) best_density = std::max(best_density, frontalDensity(axis, face));
    for (size_t c = 0; c < count; ++c) {
      if (!(some >> c & 1)) continue;
      double p = 0;
      if (options.penalty == Penalty::Axis) p = penalty(face.normal, axes[c].forward);
      if (options.penalty == Penalty::Ray) p = rayPenalty(axes[c], face);
      if (options.penalty == Penalty::Resolution) p = resolutionPenalty(axes[c], face, best_density);
      if (out.partial[f] >> c & 1) p = partialPenalty(p, seen.of(c));
      out.penalty[f * count + c] = static_cast<float>(std::clamp(p, 0.0, 1.0));
    }
  }
  return out;
}

std::vector<float> steadyFractions(std::span<const std::vector<float>> fractions, size_t middle,
                                   const FaceCostOptions& options) {
  std::vector<float> out = fractions[middle];
  const int frames = static_cast<int>(fractions.size());
  const float just_hidden = std::nextafter(options.visible_fraction, 0.0f);
  for (size_t i = 0; i < out.size(); ++i) {
    int votes = 0;
    for (const std::vector<float>& frame : fractions) votes += frame[i] >= options.visible_fraction;
    if (2 * votes > frames && out[i] >= options.fallback_fraction) out[i] = std::max(out[i], options.visible_fraction);
    if (2 * votes < frames) out[i] = std::min(out[i], just_hidden);  // a tie changes nothing
  }
  return out;
}

}  // namespace fourdvt::bake

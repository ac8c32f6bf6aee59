// SPDX-License-Identifier: Apache-2.0
#include "bake/method/shared_sight.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::bake {
namespace {

constexpr int kMostPixels = 512;        // of the longer side of a buffer
constexpr double kTolerance_m = 0.015;  // of the depth test, of a person's surface
constexpr double kLeastCosine = 0.1;    // as render::MethodOptions

PinholeCamera coarser(const PinholeCamera& camera) {
  const int longest = std::max(camera.width, camera.height);
  if (longest <= kMostPixels) return camera;
  const auto side = [&](int pixels) { return std::max(1, int(int64_t(pixels) * kMostPixels / longest)); };
  return scaledCamera(camera, side(camera.width), side(camera.height));
}

struct SurfacePoint {
  glm::dvec3 point{0}, normal{0};
};

// Perspective-correct.
SurfacePoint pointAt(const ProjectedFace& t, const glm::uvec3& face, const TriangleMesh& surface,
                     const std::vector<glm::vec3>& normals, const glm::dvec2& sample) {
  double w[3], sum = 0;
  t.barycentric(sample, w);
  for (int k = 0; k < 3; ++k) sum += w[k] *= t.inverse_depth[k];
  SurfacePoint out;
  for (int k = 0; k < 3; ++k) {
    out.point += (w[k] / sum) * glm::dvec3(surface.positions[face[k]]);
    out.normal += (w[k] / sum) * glm::dvec3(normals[face[k]]);
  }
  out.normal /= std::max(glm::length(out.normal), 1e-12);
  return out;
}

}  // namespace

SharedSight::SharedSight(const std::vector<PinholeCamera>& cameras, const TriangleMesh& surface, double length_scale)
    : surface_(surface), tolerance_m_(length_scale * kTolerance_m) {
  computeVertexNormals(surface.faces, surface.positions.data(), surface.positions.size(), normals_);
  for (const PinholeCamera& camera : cameras) {
    const PinholeCamera coarse = coarser(camera);
    seen_.push_back({coarse, coarse.centreInWorld(), rasterise(coarse, surface.faces, surface.positions, 1)});
  }
}

double SharedSight::secondShare(const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& to_eye,
                                std::optional<size_t> left_out) const {
  double sum = 0, first = 0, second = 0;
  for (size_t c = 0; c < seen_.size(); ++c) {
    if (c == left_out) continue;
    const Seen& s = seen_[c];
    const glm::dvec3 to_camera = glm::normalize(s.centre_in_world - point);
    const double cosine = glm::dot(normal, to_camera), weight = cosine * glm::dot(to_camera, to_eye);
    if (cosine <= kLeastCosine || weight <= 0) continue;
    const glm::dvec3 at = s.camera.project(point);
    if (at.z <= 0 || at.x < 0 || at.y < 0 || at.x >= s.camera.width || at.y >= s.camera.height) continue;
    const float nearest_m = s.buffer.depth_m[size_t(at.y) * size_t(s.buffer.width) + size_t(at.x)];
    if (at.z > nearest_m + tolerance_m_) continue;
    sum += weight;
    second = std::max(second, std::min(first, weight));
    first = std::max(first, weight);
  }
  return sum > 0 ? second / sum : 0;
}

measure::Mask SharedSight::of(const PinholeCamera& view, std::optional<size_t> left_out) const {
  const PinholeCamera coarse = coarser(view);
  const FaceBuffer shown = rasterise(coarse, surface_.faces, surface_.positions, 1);
  const glm::dvec3 eye = view.centreInWorld();
  measure::Mask few(size_t(coarse.width) * size_t(coarse.height), 0);
  for (size_t i = 0; i < few.size(); ++i) {
    ProjectedFace t;
    if (shown.face[i] == FaceBuffer::kNoFace) continue;
    const glm::uvec3& face = surface_.faces[shown.face[i]];
    if (!projectFace(coarse, face, surface_.positions, 1, t)) continue;
    const glm::dvec2 sample(double(i % size_t(coarse.width)) + 0.5, double(i / size_t(coarse.width)) + 0.5);
    const SurfacePoint s = pointAt(t, face, surface_, normals_, sample);
    few[i] = secondShare(s.point, s.normal, glm::normalize(eye - s.point), left_out) >= kSharedWeight;
  }
  if (coarse.width == view.width && coarse.height == view.height) return few;
  measure::Mask out(size_t(view.width) * size_t(view.height));
  for (size_t y = 0; y < size_t(view.height); ++y)
    for (size_t x = 0; x < size_t(view.width); ++x)
      out[y * size_t(view.width) + x] = few[y * size_t(coarse.height) / size_t(view.height) * size_t(coarse.width) +
                                            x * size_t(coarse.width) / size_t(view.width)];
  return out;
}

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
#include "bake/order.h"

#include <algorithm>

#include "package/character.h"

namespace fourdvt::bake {
namespace {

struct Candidate {
  double penalty;
  uint8_t camera;
  bool operator<(const Candidate& o) const { return penalty != o.penalty ? penalty < o.penalty : camera < o.camera; }
};

struct CameraAxis {
  glm::dvec3 centre, forward;
};

void collect(std::span<const CameraAxis> axes, const glm::dvec3& normal, const glm::dvec3& centre, size_t face,
             size_t face_count, std::span<const float> fractions, float least, std::vector<Candidate>& out) {
  out.clear();
  for (size_t c = 0; c < axes.size(); ++c) {
    if (fractions[c * face_count + face] < least || !facesCamera(normal, centre, axes[c].centre)) continue;
    out.push_back({penalty(normal, axes[c].forward), static_cast<uint8_t>(c)});
  }
  std::sort(out.begin(), out.end());
}

}  // namespace

double penalty(const glm::dvec3& normal, const glm::dvec3& optical_axis) {
  const double cosine = glm::dot(normal, optical_axis);
  return 1 - cosine * cosine;
}

bool facesCamera(const glm::dvec3& normal, const glm::dvec3& face_centre, const glm::dvec3& camera_centre) {
  return glm::dot(normal, camera_centre - face_centre) > 0;
}

std::vector<uint8_t> labelFaces(const LabelOptions& options, std::span<const PinholeCamera> cameras,
                                const MeshTopology& topology, const Positions& positions,
                                std::span<const float> fractions) {
  std::vector<CameraAxis> axes;
  for (const PinholeCamera& camera : cameras) axes.push_back({camera.centreInWorld(), camera.forwardInWorld()});
  const size_t faces = topology.faceCount();
  std::vector<uint8_t> labels(options.layers * faces, package::kNoCamera);
  std::vector<Candidate> candidates;
  for (size_t f = 0; f < faces; ++f) {
    const glm::uvec3 v = topology.face_vertices[f];
    const glm::dvec3 a(positions[v.x]), b(positions[v.y]), c(positions[v.z]);
    const glm::dvec3 area_normal = glm::cross(b - a, c - a);
    const double length = glm::length(area_normal);
    if (length < 1e-14) continue;
    const glm::dvec3 normal = area_normal / length, centre = (a + b + c) / 3.0;
    collect(axes, normal, centre, f, faces, fractions, options.visible_fraction, candidates);
    if (candidates.empty()) collect(axes, normal, centre, f, faces, fractions, options.fallback_fraction, candidates);
    for (size_t l = 0; l < std::min<size_t>(options.layers, candidates.size()); ++l)
      labels[l * faces + f] = candidates[l].camera;
  }
  return labels;
}

}  // namespace fourdvt::bake

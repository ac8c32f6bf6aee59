// SPDX-License-Identifier: Apache-2.0
#include "base/face_buffer.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fourdvt {
namespace {

double edge(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

}  // namespace

bool ProjectedFace::barycentric(const glm::dvec2& sample, double weights[3]) const {
  const double area = edge(at[0], at[1], at[2]);
  if (std::abs(area) < 1e-12) return false;
  weights[0] = edge(at[1], at[2], sample) / area;
  weights[1] = edge(at[2], at[0], sample) / area;
  weights[2] = 1 - weights[0] - weights[1];
  return weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0;
}

bool projectFace(const PinholeCamera& camera, const glm::uvec3& f, const Positions& positions, int scale,
                 ProjectedFace& out) {
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 p = camera.project(glm::dvec3(positions[f[k]]));
    if (p.z <= 1e-6) return false;
    out.at[k] = glm::dvec2(p) * double(scale);
    out.inverse_depth[k] = 1 / p.z;
  }
  return true;
}

FaceBuffer rasterise(const PinholeCamera& camera, const std::vector<glm::uvec3>& face_vertices,
                     const Positions& positions, int scale) {
  FaceBuffer out{camera.width * scale, camera.height * scale, {}, {}};
  out.depth_m.assign(static_cast<size_t>(out.width) * out.height, std::numeric_limits<float>::infinity());
  out.face.assign(out.depth_m.size(), FaceBuffer::kNoFace);
  ProjectedFace t;
  for (uint32_t f = 0; f < face_vertices.size(); ++f) {
    if (!projectFace(camera, face_vertices[f], positions, scale, t)) continue;
    const glm::dvec2 low = glm::min(t.at[0], glm::min(t.at[1], t.at[2])),
                     high = glm::max(t.at[0], glm::max(t.at[1], t.at[2]));
    const int x1 = static_cast<int>(std::min(std::ceil(high.x), double(out.width)));
    const int y1 = static_cast<int>(std::min(std::ceil(high.y), double(out.height)));
    for (int y = static_cast<int>(std::max(std::floor(low.y), 0.0)); y < y1; ++y) {
      for (int x = static_cast<int>(std::max(std::floor(low.x), 0.0)); x < x1; ++x) {
        double w[3];
        if (!t.barycentric({x + 0.5, y + 0.5}, w)) continue;
        const double inverse = w[0] * t.inverse_depth[0] + w[1] * t.inverse_depth[1] + w[2] * t.inverse_depth[2];
        const float depth = static_cast<float>(1 / inverse);
        const size_t at = static_cast<size_t>(y) * out.width + x;
        if (depth < out.depth_m[at]) {
          out.depth_m[at] = depth;
          out.face[at] = f;
        }
      }
    }
  }
  return out;
}

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
#include "base/face_buffer.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fourdvt {
namespace {

constexpr double kMinArea = 1e-12, kNearest_m = 1e-6;

double edge(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

}  // namespace

bool ProjectedFace::barycentric(const glm::dvec2& sample, double weights[3]) const {
  const double area = edge(at[0], at[1], at[2]);
  if (std::abs(area) < kMinArea) return false;
  weights[0] = edge(at[1], at[2], sample) / area;
  weights[1] = edge(at[2], at[0], sample) / area;
  weights[2] = 1 - weights[0] - weights[1];
  return weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0;
}

bool projectFace(const PinholeCamera& camera, const glm::uvec3& f, const Positions& positions, int scale,
                 ProjectedFace& out) {
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 p = camera.project(glm::dvec3(positions[f[k]]));
    if (p.z <= kNearest_m) return false;
    out.at[k] = glm::dvec2(p) * double(scale);
    out.inverse_depth[k] = 1 / p.z;
  }
  return true;
}

namespace {

struct Corner {
  glm::dvec2 at{0};          // samples
  double inverse_depth = 0;  // 1/m; 0: behind the camera
};

std::vector<Corner> project(const PinholeCamera& camera, const Positions& positions, int scale) {
  std::vector<Corner> out(positions.size());
  for (size_t v = 0; v < out.size(); ++v) {
    const glm::dvec3 p = camera.project(glm::dvec3(positions[v]));
    if (p.z > kNearest_m) out[v] = {glm::dvec2(p) * double(scale), 1 / p.z};
  }
  return out;
}

int floorOf(double v) {
  const int towards_zero = int(v);
  return towards_zero - (v < towards_zero);
}

// Calls `place` with the face, the index of a sample and its inverse depth for every sample centre in a face;
// skips samples for which `open` returns false.
template <class Open, class Place>
void rasteriseInto(int width, int height, const std::vector<Corner>& corners, const std::vector<glm::uvec3>& faces,
                   const Open& open, const Place& place) {
  for (uint32_t f = 0; f < faces.size(); ++f) {
    const Corner &a = corners[faces[f].x], &b = corners[faces[f].y], &c = corners[faces[f].z];
    if (a.inverse_depth == 0 || b.inverse_depth == 0 || c.inverse_depth == 0) continue;
    const double area = edge(a.at, b.at, c.at);
    if (!(std::abs(area) >= kMinArea)) continue;
    const glm::dvec2 low = glm::min(a.at, glm::min(b.at, c.at)), high = glm::max(a.at, glm::max(b.at, c.at));
    // Samples beyond the box by more than the rounding of a weight have a negative weight.
    const double size = std::max(high.x - low.x, high.y - low.y);
    const double spare = 1e-9 + 1e-12 * size * size * size / std::abs(area);
    const auto first = [&](double from, double count) {
      return std::max(-floorOf(-std::clamp(from - 0.5 - spare, 0.0, count)), floorOf(std::clamp(from, 0.0, count)));
    };
    const auto end = [&](double to, double count) {
      return std::min(floorOf(std::clamp(to + 0.5 + spare, 0.0, count)), -floorOf(-std::clamp(to, 0.0, count)));
    };
    const int x0 = first(low.x, width), x1 = end(high.x, width), y1 = end(high.y, height);
    const glm::dvec2 bc = c.at - b.at, ca = a.at - c.at;
    const double inside = area > 0 ? 1 : -1;
    for (int y = first(low.y, height); y < y1; ++y) {
      const double row_a = bc.x * (y + 0.5 - b.at.y), row_b = ca.x * (y + 0.5 - c.at.y);
      for (int x = x0; x < x1; ++x) {
        const size_t at = size_t(y) * width + x;
        if (!open(at)) continue;
        const double edge_a = row_a - bc.y * (x + 0.5 - b.at.x), edge_b = row_b - ca.y * (x + 0.5 - c.at.x);
        if (edge_a * inside < 0 || edge_b * inside < 0) continue;
        const double of_a = edge_a / area, of_b = edge_b / area, of_c = 1 - of_a - of_b;
        if (of_c >= 0) place(f, at, of_a * a.inverse_depth + of_b * b.inverse_depth + of_c * c.inverse_depth);
      }
    }
  }
}

}  // namespace

FaceBuffer rasterise(const PinholeCamera& camera, const std::vector<glm::uvec3>& face_vertices,
                     const Positions& positions, int scale) {
  FaceBuffer out{camera.width * scale, camera.height * scale, {}, {}};
  out.depth_m.assign(static_cast<size_t>(out.width) * out.height, std::numeric_limits<float>::infinity());
  out.face.assign(out.depth_m.size(), FaceBuffer::kNoFace);
  rasteriseInto(
      out.width, out.height, project(camera, positions, scale), face_vertices, [](size_t) { return true; },
      [&](uint32_t f, size_t at, double inverse_depth) {
        const float depth = static_cast<float>(1 / inverse_depth);
        if (depth < out.depth_m[at]) {
          out.depth_m[at] = depth;
          out.face[at] = f;
        }
      });
  return out;
}

std::vector<uint8_t> coveredSamples(const PinholeCamera& camera, const std::vector<glm::uvec3>& face_vertices,
                                    const Positions& positions, int scale) {
  const int width = camera.width * scale, height = camera.height * scale;
  std::vector<uint8_t> out(size_t(width) * height, 0);
  rasteriseInto(
      width, height, project(camera, positions, scale), face_vertices, [&](size_t at) { return out[at] == 0; },
      [&](uint32_t, size_t at, double) { out[at] = 1; });
  return out;
}

}  // namespace fourdvt

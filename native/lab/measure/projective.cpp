// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/projective.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/face_buffer.h"
#include "base/mesh.h"

namespace fourdvt::measure {
namespace {

struct Surface {
  glm::dvec3 point_in_world, normal_in_world;
};

// Perspective-correct point and shading normal of a face at a sample.
Surface surfaceAt(const ProjectedFace& t, const glm::uvec3& f, const Positions& positions,
                  const std::vector<glm::vec3>& normals, const glm::dvec2& sample) {
  double w[3];
  t.barycentric(sample, w);
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += w[k] *= t.inverse_depth[k];
  Surface s{glm::dvec3(0), glm::dvec3(0)};
  for (int k = 0; k < 3; ++k) {
    s.point_in_world += (w[k] / sum) * glm::dvec3(positions[f[k]]);
    s.normal_in_world += (w[k] / sum) * glm::dvec3(normals[f[k]]);
  }
  s.normal_in_world /= std::max(glm::length(s.normal_in_world), 1e-12);
  return s;
}

glm::dvec3 bilinear(const Image& image, double x, double y) {
  x = std::clamp(x - 0.5, 0.0, image.width - 1.0);
  y = std::clamp(y - 0.5, 0.0, image.height - 1.0);
  const int x0 = std::min(static_cast<int>(x), image.width - 2), y0 = std::min(static_cast<int>(y), image.height - 2);
  const double fx = x - x0, fy = y - y0;
  glm::dvec3 out(0);
  for (int c = 0; c < 3; ++c) {
    const double top = image.at(x0, y0)[c] * (1 - fx) + image.at(x0 + 1, y0)[c] * fx;
    const double bottom = image.at(x0, y0 + 1)[c] * (1 - fx) + image.at(x0 + 1, y0 + 1)[c] * fx;
    out[c] = top * (1 - fy) + bottom * fy;
  }
  return out;
}

struct Source {
  const PinholeCamera* camera;
  const Image* picture;
  FaceBuffer depths;
  glm::dvec3 centre_in_world;
};

// LVDT Eq. 3 (corrected): max(-c_D·n, 0) · max(c_D·c_v, 0); Eq. 4: normalised sum.
glm::dvec3 blendedColour(const std::vector<Source>& sources, const Surface& s, const glm::dvec3& view_ray,
                         double tolerance_m) {
  glm::dvec3 sum(0), fallback(0);
  double total = 0, best = -2;
  for (const Source& source : sources) {
    const glm::dvec3 ray = glm::normalize(s.point_in_world - source.centre_in_world);
    const double facing = -glm::dot(ray, s.normal_in_world);
    const glm::dvec3 p = source.camera->project(s.point_in_world);
    if (p.z <= 0 || p.x < 0 || p.y < 0 || p.x >= source.camera->width || p.y >= source.camera->height) continue;
    const size_t at = static_cast<size_t>(p.y) * source.depths.width + static_cast<size_t>(p.x);
    const bool seen = p.z <= source.depths.depth_m[at] + tolerance_m;
    const double weight = seen ? std::max(facing, 0.0) * std::max(glm::dot(ray, view_ray), 0.0) : 0;
    if (weight <= 0 && facing <= best) continue;
    const glm::dvec3 colour = bilinear(*source.picture, p.x, p.y);
    if (facing > best) {
      best = facing;
      fallback = colour;
    }
    sum += weight * colour;
    total += weight;
  }
  return total > 1e-9 ? sum / total : fallback;
}

}  // namespace

Image renderProjective(const PinholeCamera& view, std::span<const PinholeCamera> cameras,
                       std::span<const Image> pictures, const std::vector<glm::uvec3>& face_vertices,
                       const Positions& positions, const ProjectiveOptions& options) {
  std::vector<glm::vec3> normals;
  computeVertexNormals(face_vertices, positions.data(), positions.size(), normals);
  std::vector<Source> sources;
  for (size_t c = 0; c < cameras.size(); ++c)
    sources.push_back(
        {&cameras[c], &pictures[c], rasterise(cameras[c], face_vertices, positions, 1), cameras[c].centreInWorld()});
  const int n = options.samples;
  const FaceBuffer seen = rasterise(view, face_vertices, positions, n);
  const glm::dvec3 eye = view.centreInWorld();
  const double scale = positions.empty() ? 1 : lengthScale({longestSide(positions)});
  const double tolerance_m = scale * options.depth_tolerance_m;
  Image out(view.width, view.height, 4);
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      glm::dvec3 sum(0);
      int covered = 0;
      for (int k = 0; k < n * n; ++k) {
        const int sx = x * n + k % n, sy = y * n + k / n;
        const uint32_t face = seen.face[static_cast<size_t>(sy) * seen.width + sx];
        if (face == FaceBuffer::kNoFace) continue;
        ProjectedFace t;
        projectFace(view, face_vertices[face], positions, n, t);
        const Surface s = surfaceAt(t, face_vertices[face], positions, normals, {sx + 0.5, sy + 0.5});
        sum += blendedColour(sources, s, glm::normalize(s.point_in_world - eye), tolerance_m);
        ++covered;
      }
      if (!covered) continue;
      uint8_t* p = out.at(x, y);
      for (int c = 0; c < 3; ++c) p[c] = static_cast<uint8_t>(std::clamp(sum[c] / covered + 0.5, 0.0, 255.0));
      p[3] = static_cast<uint8_t>(255.0 * covered / (n * n) + 0.5);
    }
  }
  return out;
}

}  // namespace fourdvt::measure

// SPDX-License-Identifier: Apache-2.0
#include "encode/surfaces.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "base/face_buffer.h"
#include "base/hash.h"
#include "base/image.h"
#include "base/mesh.h"

namespace fourdvt::encode {
namespace {

struct PlaceHash {
  size_t operator()(const glm::vec3& p) const { return fnv1a({reinterpret_cast<const uint8_t*>(&p), sizeof p}); }
};

// [vertex]: the first vertex at its place. -0 and 0 count as two places, which costs one vertex.
std::vector<uint32_t> firstAtPlace(const Positions& positions) {
  std::vector<uint32_t> first;
  std::unordered_map<glm::vec3, uint32_t, PlaceHash> known;
  for (uint32_t v = 0; v < positions.size(); ++v) first.push_back(known.emplace(positions[v], v).first->second);
  return first;
}

void weld(const Positions& positions, std::vector<glm::uvec3>& faces) {
  const std::vector<uint32_t> first = firstAtPlace(positions);
  for (glm::uvec3& face : faces) face = {first[face.x], first[face.y], first[face.z]};
}

}  // namespace

TriangleMesh simplified(TriangleMesh surface, size_t max_faces) {
  if (max_faces == 0 || surface.faces.size() <= max_faces) return surface;
  constexpr float kAnyError = 1;  // relative to the mesh's extent: only the number of faces limits
  weld(surface.positions, surface.faces);
  dropUnusedVertices(surface);  // meshoptimizer treats vertices at one place as seams and keeps them
  std::vector<glm::uvec3> kept(surface.faces.size());
  const size_t indices =
      meshopt_simplify(&kept[0].x, &surface.faces[0].x, 3 * surface.faces.size(), &surface.positions[0].x,
                       surface.positions.size(), sizeof(glm::vec3), 3 * max_faces, kAnyError, 0, nullptr);
  kept.resize(indices / 3);
  surface.faces = std::move(kept);
  return surface;
}

package::QuantisedSurface quantisedSurface(const PositionGrid& grid, const Positions& positions,
                                           const std::vector<glm::uvec3>& faces, bool welds) {
  package::QuantisedSurface out{faces, {}};
  for (const glm::vec3& p : positions)
    out.positions.emplace_back(glm::round((glm::dvec3(p) - grid.origin_m) / grid.step_m));
  if (welds) weld(positions, out.faces);
  return out;
}

namespace {

constexpr int kMaxDepthSamples = 1024;      // along the longer side of a depth map
constexpr double kMinCosine = 0.2;          // between normal and ray; pictures at grazing angles are smeared
constexpr double kFootprintEdges = 1 / 3.;  // half the side of a vertex's averaging square, in mean edges
constexpr double kMaxFootprintPixels = 12;
constexpr double kSlackEdges = 0.5;  // tolerance of the depth test
constexpr double kMidGrey = 0.2140;  // linear, of sRGB 0.5

const std::array<double, 256>& linearOfSrgb() {
  static const std::array<double, 256> table = [] {
    std::array<double, 256> out{};
    for (int i = 0; i < 256; ++i) out[size_t(i)] = linearFromSrgb(i / 255.);
    return out;
  }();
  return table;
}

double meanEdge(const TriangleMesh& surface) {
  double sum = 0;
  for (const glm::uvec3& f : surface.faces)
    for (int c = 0; c < 3; ++c) sum += glm::distance(surface.positions[f[c]], surface.positions[f[(c + 1) % 3]]);
  return surface.faces.empty() ? 0 : sum / (3. * double(surface.faces.size()));
}

struct Mean {
  glm::dvec3 sum{0};
  double weight = 0;
};

// Averages the linear colours of pixels that show the performer. False if there are none.
bool sampleSquare(const Image& picture, const glm::dvec2& at, int radius, glm::dvec3& colour) {
  const int x0 = std::max(0, int(std::floor(at.x)) - radius),
            x1 = std::min(picture.width - 1, int(std::floor(at.x)) + radius);
  const int y0 = std::max(0, int(std::floor(at.y)) - radius),
            y1 = std::min(picture.height - 1, int(std::floor(at.y)) + radius);
  const auto& linear = linearOfSrgb();
  glm::dvec3 sum{0};
  int count = 0;
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const uint8_t* p = picture.at(x, y);
      if (p[3] < 128) continue;
      sum += glm::dvec3(linear[p[0]], linear[p[1]], linear[p[2]]);
      ++count;
    }
  }
  if (count > 0) colour = sum / double(count);
  return count > 0;
}

void addCamera(const TriangleMesh& surface, const std::vector<glm::vec3>& normals, double edge_m,
               const PinholeCamera& camera, const Image& picture, std::vector<Mean>& colours) {
  const int factor = std::max(1, (std::max(camera.width, camera.height) + kMaxDepthSamples - 1) / kMaxDepthSamples);
  const FaceBuffer depth = rasterise(reducedCamera(camera, factor), surface.faces, surface.positions, 1);
  const glm::dvec3 centre = camera.centreInWorld();
  for (size_t v = 0; v < surface.positions.size(); ++v) {
    const glm::dvec3 point(surface.positions[v]);
    const double cosine = glm::dot(glm::dvec3(normals[v]), glm::normalize(centre - point));
    const glm::dvec3 at = camera.project(point);
    const bool inside = at.z > 0 && at.x >= 0 && at.y >= 0 && at.x < camera.width && at.y < camera.height;
    if (!inside || !(cosine >= kMinCosine)) continue;
    const auto x = size_t(at.x * depth.width / camera.width), y = size_t(at.y * depth.height / camera.height);
    if (double(depth.depth_m[y * size_t(depth.width) + x]) < at.z - kSlackEdges * edge_m) continue;
    const double footprint = std::min(kMaxFootprintPixels, kFootprintEdges * edge_m * camera.fx / at.z);
    glm::dvec3 colour;
    if (!sampleSquare(picture, at, int(footprint), colour)) continue;
    const double weight = std::pow(cosine, 4);
    colours[v].sum += weight * colour;
    colours[v].weight += weight;
  }
}

// Fills vertices without a colour with the mean of their coloured neighbours, ring by ring.
void fillFromNeighbours(const std::vector<glm::uvec3>& faces, std::vector<Mean>& colours) {
  for (bool filled = true; filled;) {
    filled = false;
    std::vector<Mean> next(colours.size());
    for (const glm::uvec3& f : faces) {
      for (int c = 0; c < 3; ++c) {
        const Mean& from = colours[f[c]];
        if (from.weight <= 0) continue;
        for (int other = 1; other < 3; ++other) {
          const uint32_t to = f[(c + other) % 3];
          if (colours[to].weight > 0) continue;
          next[to].sum += from.sum / from.weight;
          next[to].weight += 1;
          filled = true;
        }
      }
    }
    for (size_t v = 0; v < colours.size(); ++v)
      if (next[v].weight > 0) colours[v] = next[v];
  }
}

}  // namespace

std::vector<glm::u16vec3> vertexColours(const TriangleMesh& surface, const std::vector<PinholeCamera>& cameras,
                                        std::span<const Image> pictures) {
  std::vector<glm::vec3> normals;
  computeVertexNormals(surface.faces, surface.positions.data(), surface.positions.size(), normals);
  std::vector<Mean> colours(surface.positions.size());
  const double edge_m = meanEdge(surface);
  for (size_t c = 0; c < cameras.size(); ++c) addCamera(surface, normals, edge_m, cameras[c], pictures[c], colours);
  fillFromNeighbours(surface.faces, colours);
  std::vector<glm::u16vec3> out;
  for (const Mean& mean : colours) {
    const glm::dvec3 linear = mean.weight > 0 ? mean.sum / mean.weight : glm::dvec3(kMidGrey);
    out.emplace_back(glm::round(glm::clamp(linear, 0., 1.) * 65535.));
  }
  return out;
}

}  // namespace fourdvt::encode

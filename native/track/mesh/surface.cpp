// SPDX-License-Identifier: Apache-2.0
#include "track/mesh/surface.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace fourdvt::track {
namespace {

constexpr double kHiddenDiscount = 0.75;   // share of a seam's cost that a hidden place saves
constexpr double kConcaveDiscount = 0.5;   // the same for a fold of 90° or more to the inside
constexpr double kConvexSurcharge = 0.25;  // added for a fold of 90° or more to the outside

Status checkPoints(const TriangleMesh& mesh) {
  if (mesh.faces.empty()) return Error{ErrorId::MeshTopology, "the mesh to unwrap has no faces"};
  for (size_t f = 0; f < mesh.faces.size(); ++f)
    for (int k = 0; k < 3; ++k)
      if (mesh.faces[f][k] >= mesh.positions.size())
        return Error{ErrorId::MeshIndex, "face " + std::to_string(f) + " of the mesh to unwrap names vertex " +
                                             std::to_string(mesh.faces[f][k]) + ", which does not exist"};
  for (size_t v = 0; v < mesh.positions.size(); ++v)
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(mesh.positions[v][k]))
        return Error{ErrorId::MeshNotFinite,
                     "vertex " + std::to_string(v) + " of the mesh to unwrap is not a finite number"};
  return {};
}

std::string edgeName(const Surface& s, uint32_t half_edge) {
  return "the edge between vertices " + std::to_string(s.from(half_edge)) + " and " + std::to_string(s.to(half_edge));
}

Status findTwins(Surface& s) {
  std::vector<std::pair<uint64_t, uint32_t>> directed;
  const auto key = [](uint32_t a, uint32_t b) { return uint64_t(a) << 32 | b; };
  for (uint32_t h = 0; h < 3 * s.faceCount(); ++h) directed.emplace_back(key(s.from(h), s.to(h)), h);
  std::sort(directed.begin(), directed.end());
  s.twins.resize(directed.size());
  for (size_t i = 0; i < directed.size(); ++i) {
    const uint32_t h = directed[i].second;
    if (s.from(h) == s.to(h) || (i > 0 && directed[i].first == directed[i - 1].first))
      return Error{ErrorId::MeshTopology, edgeName(s, h) +
                                              " has more than two faces, or two that face opposite ways; "
                                              "repair the mesh before it is unwrapped"};
    const uint64_t wanted = key(s.to(h), s.from(h));
    const auto it = std::lower_bound(directed.begin(), directed.end(), std::pair{wanted, uint32_t(0)});
    if (it == directed.end() || it->first != wanted)
      return Error{ErrorId::MeshTopology, edgeName(s, h) + " has one face; close the mesh before it is unwrapped"};
    s.twins[h] = it->second;
  }
  return {};
}

// Visits the fan of the first half-edge of each vertex; a second fan leaves half-edges over.
Status checkFans(const Surface& s) {
  std::vector<uint8_t> reached(s.points.size(), 0), seen(s.twins.size(), 0);
  for (uint32_t h = 0; h < s.twins.size(); ++h) {
    if (seen[h]) continue;
    if (std::exchange(reached[s.from(h)], uint8_t(1)))
      return Error{ErrorId::MeshTopology, "parts of the mesh touch at vertex " + std::to_string(s.from(h)) +
                                              " only; give each part its own vertex before it is unwrapped"};
    for (uint32_t spoke = h; !seen[spoke]; spoke = Surface::next(s.twins[spoke])) seen[spoke] = 1;
  }
  return {};
}

void measureFaces(Surface& s, std::span<const float> resolution) {
  for (const glm::uvec3& v : s.faces) {
    const glm::dvec3 a = s.points[v.x], b = s.points[v.y], c = s.points[v.z];
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double size = glm::length(normal);
    s.areas.push_back(size / 2);
    s.normals.push_back(size > 0 ? normal / size : glm::dvec3(0, 1, 0));
    s.centres.push_back((a + b + c) / 3.0);
    s.resolution.push_back(resolution.empty() ? 1
                                              : (double(resolution[v.x]) + resolution[v.y] + resolution[v.z]) / 3.0);
  }
}

void weighSeams(Surface& s, std::span<const float> hidden) {
  s.seam_costs.resize(s.twins.size());
  for (uint32_t h = 0; h < s.twins.size(); ++h) {
    const glm::dvec3 &own = s.normals[h / 3], &other = s.normals[s.faceAcross(h)];
    const double fold = std::min(1.0, glm::length(other - own) / std::sqrt(2.0));
    const bool concave = glm::dot(own, s.centres[s.faceAcross(h)] - s.centres[h / 3]) > 0;
    const double bend = concave ? -kConcaveDiscount : kConvexSurcharge;
    const double unseen = hidden.empty() ? 0 : std::clamp((double(hidden[s.from(h)]) + hidden[s.to(h)]) / 2, 0.0, 1.0);
    s.seam_costs[h] = (1 + bend * fold) * (1 - kHiddenDiscount * unseen);
  }
}

}  // namespace

Result<Surface> surfaceOf(const TriangleMesh& mesh, std::span<const float> resolution, std::span<const float> hidden) {
  FOURDVT_TRY(checkPoints(mesh));
  Surface s;
  s.points.assign(mesh.positions.begin(), mesh.positions.end());
  s.faces = mesh.faces;
  FOURDVT_TRY(findTwins(s));
  FOURDVT_TRY(checkFans(s));
  measureFaces(s, resolution);
  weighSeams(s, hidden);
  return s;
}

}  // namespace fourdvt::track

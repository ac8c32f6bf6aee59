// SPDX-License-Identifier: Apache-2.0
#include "bake/cameras/surfaces.h"

#include <meshoptimizer.h>

#include <unordered_map>

#include "base/hash.h"
#include "base/used_vertices.h"

namespace fourdvt::bake {
namespace {

struct PlaceHash {
  size_t operator()(const glm::vec3& p) const { return fnv1a({reinterpret_cast<const uint8_t*>(&p), sizeof p}); }
};

// [vertex]: the first vertex at its place. -0 and 0 count as two places: that costs a vertex, no more.
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

TriangleMesh simplified(TriangleMesh surface, size_t most_faces) {
  if (most_faces == 0 || surface.faces.size() <= most_faces) return surface;
  constexpr float kAnyError = 1;  // of the mesh's extent: the number of faces decides
  weld(surface.positions, surface.faces);
  dropUnusedVertices(surface);  // the library takes vertices at one place for seams, which it leaves alone
  std::vector<glm::uvec3> kept(surface.faces.size());
  const size_t indices =
      meshopt_simplify(&kept[0].x, &surface.faces[0].x, 3 * surface.faces.size(), &surface.positions[0].x,
                       surface.positions.size(), sizeof(glm::vec3), 3 * most_faces, kAnyError, 0, nullptr);
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

}  // namespace fourdvt::bake

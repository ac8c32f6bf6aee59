// SPDX-License-Identifier: Apache-2.0
// Points of the shown surface of a layered character, by the vertices of its base mesh; and the clock's time, between
// frames too.
#include <cmath>
#include <limits>

#include "player/player_impl.h"

namespace fourdvt {

namespace {

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// Depth of the triangle at the pixel, by its corners' pixels and depths; infinity where it does not cover the pixel.
double depthAt(const glm::dvec3 (&corners)[3], const glm::dvec2& pixel) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const glm::dvec2 a(corners[0]), b(corners[1]), c(corners[2]);
  const double area = cross(b - a, c - a);
  if (!(area != 0) || corners[0].z <= 0 || corners[1].z <= 0 || corners[2].z <= 0) return kNone;
  const double u = cross(b - pixel, c - pixel) / area, v = cross(c - pixel, a - pixel) / area, w = 1 - u - v;
  if (u < 0 || v < 0 || w < 0) return kNone;
  return u * corners[0].z + v * corners[1].z + w * corners[2].z;
}

}  // namespace

// Null: nothing of a layered character is on screen.
const Positions* PlayerImpl::shownPositions() const {
  if (!hasFrame() || fromCameras() || !loading_.hasMesh()) return nullptr;
  const Positions& shown = composer_.shown(main().frame, transitions_.fading());
  return shown.size() == loading_.mesh().topology.vertex_count ? &shown : nullptr;
}

double PlayerImpl::clockTime() const {
  const Track& t = main();
  if (!t.head.used()) return 0;
  const package::Sequence& s = wantedOf(t);
  const double frames = t.head.clockFrames(s.fps);
  return (frames - std::floor(frames / s.frame_count) * s.frame_count) / s.fps;  // fmod would be code of the first part
}

std::optional<SurfacePoint> PlayerImpl::surfacePoint(uint32_t vertex) const {
  const Positions* positions = shownPositions();
  if (!positions || vertex >= positions->size()) return {};
  glm::vec3 normal(0);
  for (const glm::uvec3& face : loading_.mesh().topology.face_vertices) {
    if (face.x != vertex && face.y != vertex && face.z != vertex) continue;
    const glm::vec3 a = (*positions)[face.x];
    normal += glm::cross((*positions)[face.y] - a, (*positions)[face.z] - a);
  }
  const glm::mat4 world_from_character = motion::worldFromCharacter(root_motion_.sourcePlacement());
  return SurfacePoint{glm::vec3(world_from_character * glm::vec4((*positions)[vertex], 1)),
                      glm::vec3(world_from_character * glm::vec4(normal, 0))};
}

std::optional<uint32_t> PlayerImpl::vertexAt(const PinholeCamera& camera, double x_px, double y_px) const {
  const Positions* positions = shownPositions();
  if (!positions) return {};
  const glm::dmat4 world_from_character(motion::worldFromCharacter(root_motion_.sourcePlacement()));
  std::vector<glm::dvec3> seen;
  seen.reserve(positions->size());
  for (const glm::vec3& p : *positions)
    seen.push_back(camera.project(glm::dvec3(world_from_character * glm::dvec4(p, 1))));
  const glm::dvec2 pixel(x_px, y_px);
  double nearest = std::numeric_limits<double>::infinity();
  glm::uvec3 hit(0);
  for (const glm::uvec3& face : loading_.mesh().topology.face_vertices) {
    const double depth = depthAt({seen[face.x], seen[face.y], seen[face.z]}, pixel);
    if (depth < nearest) nearest = depth, hit = face;
  }
  if (!std::isfinite(nearest)) return {};
  uint32_t best = hit.x;
  for (uint32_t corner : {hit.y, hit.z})
    if (glm::distance(glm::dvec2(seen[corner]), pixel) < glm::distance(glm::dvec2(seen[best]), pixel)) best = corner;
  return best;
}

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
// Drawing: mesh, pictures and figure of the shown frame, its programs, and surface points of a layered character by
// vertices of its base mesh.
#include <array>
#include <cmath>
#include <limits>

#include "player/player_impl.h"

namespace fourdvt {

namespace {

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// Depth of the triangle at the pixel, from its corners' pixels and depths; infinity outside of it.
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

void PlayerImpl::composeMesh() {
  for (Track* t : {&main(), &other()}) {
    if (!t->head.hasPicture() || !t->frame.stale() || !(isMain(*t) || transitions_.fading())) continue;
    const FrameGeometry geometry = geometryOf(t->head.shown().sequence, shownFrameOf(*t), true);
    if (!geometry) continue;
    t->frame.blend(geometry, t->parameters.weights());
    composer_.markStale();
  }
  if (!hasFrame()) return;
  composer_.compose(device_, main().frame, transitions_.fading() ? &other().frame : nullptr,
                    {transitions_.fade(), transitions_.shift()});
}

// Uploads the drawn parts: members with a weight, of the pictures on screen.
void PlayerImpl::stagePictures() {
  for (Track* t : {&main(), &other()}) {
    if (!t->head.hasPicture() || !(isMain(*t) || transitions_.fading())) continue;
    const package::Sequence& sequence = shownOf(*t);
    const int slot = t->head.shown().slot;
    uint32_t wanted = 1;
    const std::vector<float>& weights = t->parameters.weights().members;
    for (size_t m = 1; m < weights.size(); ++m) wanted |= uint32_t{weights[m] > 0} << m;
    if (!weights.empty() && weights[0] <= 0) wanted &= ~1u;
    const Status staged = t->slots.stage(device_, slot, sequence.renditions[t->slots.rendition(slot)],
                                         std::max<size_t>(1, sequence.members.size()), wanted);
    if (!staged.ok()) giveUp(*t, staged.error());
  }
}

Result<render::Figure> PlayerImpl::figure() const {
  if (!hasFrame()) return Error{ErrorId::InvalidArgument, "nothing to draw yet: wait for canplay"};
  const glm::mat4 world_from_character = motion::worldFromCharacter(root_motion_.sourcePlacement());
  if (fromCameras())
    return composer_.cameraFigure(main().frame, main().slots.picture(main().head.shown().slot), world_from_character);
  const auto look = [](const Track& t) {
    return render::Look{&t.frame.appearance(), &t.slots.picture(t.head.shown().slot), t.parameters.weights().members};
  };
  std::array<render::Look, 2> looks{look(main())};
  if (transitions_.fading()) looks[1] = look(other());
  return composer_.figure(std::span(looks.data(), transitions_.fading() ? 2 : 1), transitions_.fade(),
                          world_from_character);
}

Status Player::draw(const render::View& view, const render::RecipeOptions& options, gpu::TargetId target) {
  auto drawn = figure();
  if (!drawn.ok()) return drawn.error();
  return recipe_->draw({&drawn.value(), 1}, nullptr, view, {options, align_, method_}, target);
}

// Requests programs for at most one member more than the space has parameters, with alignment if the loaded headers
// have it. Ignores errors: drawing reports persistent ones.
bool PlayerImpl::makeNextProgram(const render::RecipeOptions& options) {
  if (!hasFrame() || fromCameras()) return false;
  size_t max_members = 1;
  bool aligned = true;
  for (int i = 0; i < loading_.sequenceCount(); ++i) {
    const package::Sequence& s = loading_.sequence(i);
    max_members = std::max(max_members, std::min(s.members.size(), s.space.names.size() + 1));
    if (s.isClass() && loading_.hasHeader(i)) aligned = loading_.index(i).alignment_count > 0;
  }
  auto made = recipe_->makeNextProgram(character()->layer_count, static_cast<int>(max_members), aligned,
                                       options_.picture_kind, {options, align_});
  return made.ok() && made.value();
}

// Null: no layered character on screen.
const Positions* PlayerImpl::shownPositions() const {
  if (!hasFrame() || fromCameras() || !loading_.hasMesh()) return nullptr;
  const Positions& shown = composer_.shown(main().frame, transitions_.fading());
  return shown.size() == loading_.mesh().topology.vertex_count ? &shown : nullptr;
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

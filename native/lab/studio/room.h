// SPDX-License-Identifier: Apache-2.0
// A furnished room round the actor, in place of the green studio: textured floor and walls, partly in the actor's own
// colours, and the shadow that the actor throws on them under one lamp at infinity. Drawn on the CPU, four samples a
// pixel. Does NOT throw shadows on the actor, and has no reflections and no ceiling.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"
#include "lab/studio/actors/actor.h"
#include "lab/studio/lens.h"
#include "lab/studio/rig.h"
#include "lab/studio/shadow.h"

namespace fourdvt::studio {

class Room {
 public:
  // Walls stand behind the ring's cameras; `seed` chooses textures, furniture and the lamp's direction. `size_m`: the
  // length of a wall, at least leastSize_m; 0: a quarter more than that. `penumbra_m`:
  // radius of the shadow's soft edge; 0: hard. `lens`: of all cameras.
  Room(uint32_t seed, const Rig& rig, double ground_y_m, const Actor& actor, double size_m = 0, double penumbra_m = 0,
       const Lens& lens = {});
  // The length of a wall that touches the ring's outermost camera.
  static double leastSize_m(const Rig& rig);

  // The pose, world coordinates, whose shadow lies in the room from now on. Faces are the actor's surface.
  void setShadow(const Positions& pose);
  // The same of somebody else, of these faces, whose shadow lies there as well.
  void setOtherShadow(const Positions& pose, const std::vector<glm::uvec3>& faces);
  // What a ring camera sees of the room, RGB, sRGB-encoded: without a shadow, and with the one that was set. Where the
  // lamp does not reach, linear light is kShadowLight of what it is elsewhere.
  const Image& empty(size_t camera) const { return views_[camera].lit; }
  Image emptySeenBy(const PinholeCamera& camera) const;
  Image withShadow(size_t camera) const;
  const glm::dvec3& light() const { return light_; }  // its direction, unit, downwards
  // The room as a box: from the floor up to the highest point of a wall that a ring camera sees.
  BoundingBox box() const;
  // The colour without a shadow, RGB, sRGB-encoded, 0…1, at a point of the box's floor or of one of its walls.
  glm::dvec3 colourAt(const glm::dvec3& point) const;
  // The share of each pixel that lies in the shadow, 0…255, one channel.
  Image shadow(size_t camera) const;

  static constexpr double kShadowLight = 0.33;

 private:
  struct View {
    PinholeCamera camera;
    Image lit, shaded;
  };
  struct Hit {
    int side = 0;           // 0: floor, 1…4: walls
    glm::dvec2 on_side{0};  // metres
    glm::dvec3 point{0};
  };
  Hit hit(const glm::dvec3& eye, const glm::dvec3& direction) const;
  Hit hitOfPixel(const PinholeCamera& camera, const glm::dvec2& filmed_pixel) const;
  glm::dvec3 meanColour(const PinholeCamera& camera, int x, int y) const;  // of a pixel's samples
  glm::dvec2 sidePlace(int side, const glm::dvec3& point) const;
  glm::dvec3 colour(const Hit& at) const;  // encoded, 0…1
  glm::dvec3 floorColour(const glm::dvec2& at) const;
  glm::dvec3 wallColour(int wall, const glm::dvec2& at) const;
  double shadowAt(const glm::dvec3& point) const;  // 0…1
  View makeView(const PinholeCamera& camera) const;

  const uint32_t seed_;
  const double ground_m_;
  const double half_m_;  // of the room's floor
  const Lens lens_;
  const glm::dvec3 light_;  // its direction, downwards
  const double penumbra_m_;
  Shadow shadow_;
  std::optional<Shadow> other_;
  std::vector<glm::dvec3> palette_;  // colours of the actor
  std::vector<View> views_;          // [ring camera]
};

}  // namespace fourdvt::studio

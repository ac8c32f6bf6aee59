// SPDX-License-Identifier: Apache-2.0
// Furnished room round the actor, in place of the green studio: textured floor and walls, partly in the actor's own
// colours, and the actor's shadow on them under one lamp at infinity. Drawn on the CPU, four samples a pixel. No
// shadows on the actor, no reflections, no ceiling.
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
  // Walls stand behind the ring's cameras; `seed` chooses textures, furniture and the lamp's direction. `size_m`:
  // length of a wall, at least leastSize_m; 0: 1.25 times leastSize_m. `penumbra_m`: radius of the shadow's soft edge;
  // 0: hard. `lens`: of all cameras.
  Room(uint32_t seed, const Rig& rig, double ground_y_m, const Actor& actor, double size_m = 0, double penumbra_m = 0,
       const Lens& lens = {});
  // Smallest side of a square room that holds all ring cameras.
  static double leastSize_m(const Rig& rig);

  // Sets the shadow caster's pose, world coordinates. Faces are the actor's surface.
  void setShadow(const Positions& pose);
  // Sets the pose and faces of a second caster.
  void setOtherShadow(const Positions& pose, const std::vector<glm::uvec3>& faces);
  // Room in a ring camera's picture, RGB, sRGB-encoded: without a shadow, and with the current one. In shadow, linear
  // light is multiplied by kShadowLight.
  const Image& empty(size_t camera) const { return views_[camera].lit; }
  Image emptySeenBy(const PinholeCamera& camera) const;
  Image withShadow(size_t camera) const;
  const glm::dvec3& light() const { return light_; }  // direction, unit, downwards
  // Bounding box of the room: from the floor to the highest wall point visible in a ring camera.
  BoundingBox box() const;
  // Unshadowed colour, RGB, sRGB-encoded, 0…1, at a point of the box's floor or walls.
  glm::dvec3 colourAt(const glm::dvec3& point) const;
  // Shadow coverage per pixel, 0…255, one channel.
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
  glm::dvec3 meanColour(const PinholeCamera& camera, int x, int y) const;  // mean over a pixel's samples
  glm::dvec2 sidePlace(int side, const glm::dvec3& point) const;
  glm::dvec3 colour(const Hit& at) const;  // encoded, 0…1
  glm::dvec3 floorColour(const glm::dvec2& at) const;
  glm::dvec3 wallColour(int wall, const glm::dvec2& at) const;
  double shadowAt(const glm::dvec3& point) const;  // 0…1
  View makeView(const PinholeCamera& camera) const;

  const uint32_t seed_;
  const double ground_m_;
  const double half_m_;  // half the floor's side
  const Lens lens_;
  const glm::dvec3 light_;  // direction, downwards
  const double penumbra_m_;
  Shadow shadow_;
  std::optional<Shadow> other_;
  std::vector<glm::dvec3> palette_;  // the actor's colours
  std::vector<View> views_;          // [ring camera]
};

}  // namespace fourdvt::studio

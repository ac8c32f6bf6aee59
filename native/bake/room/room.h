// SPDX-License-Identifier: Apache-2.0
// The picture of a room, which is a box, from the plates of the cameras in it (algorithms/texels.md). A point of a face
// gets the weighted mean of the cameras that see it, in float; what none sees is filled from the face's neighbourhood.
// Does NOT know what stands between a camera and the box, and does NOT read or write files.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "package/character.h"

namespace fourdvt::bake {

enum class RoomBlend {
  Mean,        // every camera that sees the point counts the same
  Feathered,   // a camera counts less towards the border of its picture, and nothing at it
  Recurrence,  // for comparison only: one camera after the other is mixed in with a share A of 1, 0.56, 0.34, …, which
               // A ← 0.06 + A / 2 makes in place of 1, 1/2, 1/3, …
};

struct RoomPlate {
  PinholeCamera camera;
  Image picture;  // RGBA of the camera's size; where alpha is not 255 the camera sees nothing
  // Colours, 0…1, are used as colour_matrix * colour + colour_offset.
  glm::mat3 colour_matrix{1};
  glm::vec3 colour_offset{0};
};

struct RoomOptions {
  RoomBlend blend = RoomBlend::Feathered;
  double feather = 0.1;      // width of the feathered border, as a share of the picture's shorter side, above 0
  double texels_per_m = 96;  // of the faces
};

// Looks points of the room up in the plates. Borrows them.
class RoomLookup {
 public:
  RoomLookup(std::span<const RoomPlate> plates, const RoomOptions& options);
  ~RoomLookup();
  struct Seen {
    glm::vec3 colour{0};  // 0…1, sRGB-encoded
    float weight = 0;     // sum of the cameras' weights
    int cameras = 0;      // that see the point
  };
  // `inward`: unit normal of the face. A camera sees a point that is in front of it and within its picture, on a face
  // whose inner side is turned to it.
  Seen at(const glm::dvec3& point_in_world, const glm::dvec3& inward) const;

 private:
  struct Plate;
  std::vector<Plate> plates_;
  RoomBlend blend_;
};

struct RoomPicture {
  package::Room room;  // without file: box, size of the picture, faces
  Image picture;       // RGB
};

// Faces of the box in one picture, each with a gutter that continues it. `texels_per_m` is lowered where the picture
// would be larger than package::kMaxPictureSide.
package::Room layOutRoom(const BoundingBox& box, double texels_per_m);
RoomPicture makeRoomPicture(const BoundingBox& box, std::span<const RoomPlate> plates, const RoomOptions& options);

// Colours for the parts of a room that no camera sees.

// Continues known colours over a surface: at a point the mean of all that is known, by inverse distance to the power of
// four, so that what is near decides. Smooth in space, hence also across the edges of a box.
class RoomFill {
 public:
  explicit RoomFill(double grain_m) : grain_m_(grain_m) {}  // distances below this count as this
  // `weight`: how many texels the colour is the mean of.
  void add(const glm::vec3& point, const glm::vec3& colour, float weight) { known_.push_back({point, colour, weight}); }
  glm::vec3 at(const glm::vec3& point) const;  // mid-grey if nothing is known

 private:
  struct Known {
    glm::vec3 point, colour;
    float weight;
  };
  double grain_m_;
  std::vector<Known> known_;
};

}  // namespace fourdvt::bake

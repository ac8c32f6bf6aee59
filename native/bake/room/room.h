// SPDX-License-Identifier: Apache-2.0
// Texture of a box-shaped room from the plates of the cameras in it (algorithms/texels.md). A point of a face gets
// the weighted mean of the cameras that see it, in float; unseen points are filled from the face's neighbourhood.
// Objects between a camera and the box are ignored: their pixels are projected onto the box. Reads and writes no
// files.
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
  Mean,       // all cameras that see the point have equal weight
  Feathered,  // a camera's weight falls to 0 towards the border of its picture
  Recurrence,  // for comparison only: cameras are blended one after the other with a share A of 1, 0.56, 0.34, … (A ←
               // 0.06 + A / 2) in place of 1, 1/2, 1/3, …
};

struct RoomPlate {
  PinholeCamera camera;
  Image picture;  // RGBA of the camera's size; pixels with alpha below 255 are unseen
  // Corrects colours, 0…1, by colour_matrix * colour + colour_offset.
  glm::mat3 colour_matrix{1};
  glm::vec3 colour_offset{0};
};

struct RoomOptions {
  RoomBlend blend = RoomBlend::Feathered;
  double feather = 0.1;      // width of the feathered border, as a share of the picture's shorter side, above 0
  double texels_per_m = 96;  // texels of the faces
};

// Samples the plates at points of the room. Plates are borrowed.
class RoomLookup {
 public:
  RoomLookup(std::span<const RoomPlate> plates, const RoomOptions& options);
  ~RoomLookup();
  struct Seen {
    glm::vec3 colour{0};  // 0…1, sRGB-encoded
    float weight = 0;     // sum of the cameras' weights
    int cameras = 0;      // number of cameras that see the point
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
  package::Room room;  // box, size of the picture, faces; no file
  Image picture;       // RGB
};

// Lays out the box's faces in one picture, each with a gutter that continues it. `texels_per_m` is lowered where the
// picture would be larger than package::kMaxPictureSide.
package::Room layOutRoom(const BoundingBox& box, double texels_per_m);
RoomPicture makeRoomPicture(const BoundingBox& box, std::span<const RoomPlate> plates, const RoomOptions& options);

// Extrapolates known colours over a surface, for parts of a room that no camera sees: the mean of all known colours,
// weighted by inverse distance to the power of four. Smooth in space, hence also across the edges of a box.
class RoomFill {
 public:
  explicit RoomFill(double grain_m) : grain_m_(grain_m) {}  // smaller distances are clamped to this
  // `weight`: number of texels that the colour averages.
  void add(const glm::vec3& point, const glm::vec3& colour, float weight) { known_.push_back({point, colour, weight}); }
  glm::vec3 at(const glm::vec3& point) const;  // mid-grey without known colours

 private:
  struct Known {
    glm::vec3 point, colour;
    float weight;
  };
  double grain_m_;
  std::vector<Known> known_;
};

}  // namespace fourdvt::bake

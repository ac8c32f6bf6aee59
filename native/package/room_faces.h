// SPDX-License-Identifier: Apache-2.0
// Mapping of a room picture's faces to the box. Face order: -x, +x, -y (floor), +y (ceiling), -z, +z, each seen from
// inside: up is +y on walls, -z on floor and ceiling.
#pragma once

#include "package/character.h"

namespace fourdvt::package {

// `u` to the right and `v` down, both 0…1 over the face.
inline glm::vec3 roomPoint(const BoundingBox& box, int face, float u, float v) {
  const int axis = face / 2;
  const bool high = face % 2 == 1, mirrored = high == (axis != 0);
  glm::vec3 share;
  share[axis] = high ? 1.0f : 0.0f;
  share[axis == 0 ? 2 : 0] = mirrored ? 1 - u : u;
  share[axis == 1 ? 2 : 1] = axis == 1 ? v : 1 - v;
  return box.min + share * (box.max - box.min);
}

}  // namespace fourdvt::package

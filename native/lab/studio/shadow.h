// SPDX-License-Identifier: Apache-2.0
// The shadow of one posed surface under a lamp at infinity: its outline on a plane across the light. Hard, or with a
// penumbra as wide everywhere as a disc throws it. Does NOT know what the shadow falls on.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"

namespace fourdvt::studio {

class Shadow {
 public:
  // `light`: its direction, unit, not vertical. `penumbra_m`: radius of the disc, across the light; 0: a hard edge.
  Shadow(const glm::dvec3& light, std::vector<glm::uvec3> faces, double penumbra_m);
  void setPose(const Positions& pose);  // world coordinates
  // The share, 0…1, of the lamp's light that the surface keeps from a point behind it; 0 before the first pose, and
  // for points before the pose's middle.
  double shareAt(const glm::dvec3& point) const;

 private:
  const glm::dvec3 light_, across_, along_;  // axes of the plane across the light
  const std::vector<glm::uvec3> faces_;
  const int radius_texels_;
  // The outline as the lamp sees it; 255 inside. Texel (0, 0) has its corner at map_origin_m_.
  Image map_;
  glm::dvec2 map_origin_m_{0};
  double depth_m_ = 0;  // of the pose's middle, along the light
};

}  // namespace fourdvt::studio

// SPDX-License-Identifier: Apache-2.0
// Shadow of one posed surface under a lamp at infinity, independent of the receiver: the surface's outline on a plane
// perpendicular to the light. The edge is hard, or a penumbra of constant width, as from a disc-shaped lamp.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"

namespace fourdvt::studio {

class Shadow {
 public:
  // `light`: direction, unit, not vertical. `penumbra_m`: half the penumbra's width, perpendicular to the light; 0: a
  // hard edge.
  Shadow(const glm::dvec3& light, std::vector<glm::uvec3> faces, double penumbra_m);
  void setPose(const Positions& pose);  // world coordinates
  // Occlusion of the lamp at a point behind the surface, 0…1; 0 before the first pose, and for points in front of the
  // pose's centre.
  double shareAt(const glm::dvec3& point) const;

 private:
  const glm::dvec3 light_, across_, along_;  // axes of the plane across the light
  const std::vector<glm::uvec3> faces_;
  const int radius_texels_;
  // Outline in the lamp's projection; 255 inside. Texel (0, 0) has its corner at map_origin_m_.
  Image map_;
  glm::dvec2 map_origin_m_{0};
  double depth_m_ = 0;  // pose's centre along the light
};

}  // namespace fourdvt::studio

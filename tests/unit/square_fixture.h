// SPDX-License-Identifier: Apache-2.0
// A square, and a camera on an orbit round it.
#pragma once

#include <cmath>
#include <vector>

#include "base/camera.h"
#include "base/mesh.h"

namespace fourdvt::testing {

// Square with sides of 1 m in the plane z = 0, facing +Z, centred on the origin.
inline const std::vector<glm::uvec3> kSquareFaces{{0, 1, 2}, {0, 2, 3}};
inline const Positions kSquare{{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}};

inline PinholeCamera orbit(double azimuth_deg, int side = 64) {
  OrbitView view;
  view.azimuth_deg = azimuth_deg;
  view.target_in_world = glm::dvec3(0);
  view.distance_m = 2;
  view.vertical_fov_deg = 2 * 180 / 3.14159265358979323846 * std::atan(0.5);  // 2 m across at the square
  return cameraFromOrbit(view, side, side);
}

}  // namespace fourdvt::testing

// SPDX-License-Identifier: Apache-2.0
// Pinhole cameras and orbit views. Camera frame as in COLMAP: x right, y down, z forward. World frame: the capture's
// (in the sample capture: metres, Y up, performer facing +Z). Pixel centres lie at (i + 0.5, j + 0.5), origin top left.
// No lens distortion: the capture reader undistorts pictures first.
#pragma once

#include <glm/glm.hpp>
#include <string>

#include "base/mesh.h"

namespace fourdvt {

struct PinholeCamera {
  std::string name;
  int width = 0, height = 0;              // pixels
  double fx = 0, fy = 0, cx = 0, cy = 0;  // pixels
  glm::dmat4 cam_from_world{1.0};

  glm::dvec3 centreInWorld() const;
  glm::dvec3 forwardInWorld() const;  // unit optical axis
  // Unit ray through the picture's centre; differs from the optical axis for shifted lenses and cropped pictures.
  glm::dvec3 middleRayInWorld() const;
  // Pixel position of a world point; z of the result is the depth along the optical axis (<= 0: behind).
  glm::dvec3 project(const glm::dvec3& point_in_world) const;
};

// Matrix from the camera frame (y down, z forward) to OpenGL clip space (z in [-w, w], y up). The picture's top row is
// the last GL row.
glm::dmat4 clipFromCam(const PinholeCamera& camera, double near_m, double far_m);
glm::dmat4 clipFromWorld(const PinholeCamera& camera, double near_m, double far_m);

// Picture region, pixels, and its depth range along the optical axis.
struct PictureRegion {
  int x = 0, y = 0, width = 0, height = 0;
  float near_m = 0, far_m = 0;
  bool empty() const { return width == 0; }
};
// Bounding region of the points in front of the camera, enlarged by 8 pixels on each side and by a tenth of the depth;
// empty if no point projects into the picture.
PictureRegion regionOf(const PinholeCamera& camera, const Positions& positions_in_world);

// View on a sphere round `target_in_world`, Y up. Azimuth 0 looks at the performer's front (camera on +Z), positive
// azimuth moves the camera towards +X; positive elevation moves it up.
struct OrbitView {
  double azimuth_deg = 0, elevation_deg = 0, distance_m = 3;
  glm::dvec3 target_in_world{0, 0.9, 0};
  double vertical_fov_deg = 35;
};

// Camera of an orbit view for a picture of this size (square pixels, centred principal point).
PinholeCamera cameraFromOrbit(const OrbitView& view, int width, int height);

// Default view of stills, turntables and the page: vertical field of view 30°, azimuth 25°, elevation 8°, target at the
// centre of the bounds. The distance is the smallest at which the bounds' upright bounding cylinder fits a picture of
// aspect width/height, with a margin of 8 %.
OrbitView defaultOrbit(const BoundingBox& bounds, double aspect);

// Adapts the camera to another picture size: keeps the narrower field of view, crops or widens the other.
PinholeCamera scaledCamera(const PinholeCamera& camera, int width, int height);

// Camera of pictures reduced by an integer factor, with sides rounded down.
PinholeCamera reducedCamera(const PinholeCamera& camera, int factor);

}  // namespace fourdvt

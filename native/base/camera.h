// SPDX-License-Identifier: Apache-2.0
// Pinhole cameras and orbit views. Camera frame: COLMAP's, x right, y down, z forward. World: as the capture says
// (the sample: metres, Y up, performer facing +Z). Pixel centres are at (i + 0.5, j + 0.5), origin top left.
// Does NOT model lens distortion: the capture reader undistorts pictures first.
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
  // Unit ray through the middle of the picture, which the optical axis misses where the lens is shifted or the picture
  // cropped.
  glm::dvec3 middleRayInWorld() const;
  // Pixel position of a world point; z of the result is the depth along the optical axis (<= 0: behind).
  glm::dvec3 project(const glm::dvec3& point_in_world) const;
};

// To OpenGL clip space (z in [-w, w], y up) from the camera frame (y down, z forward). The picture's top row is the
// last GL row.
glm::dmat4 clipFromCam(const PinholeCamera& camera, double near_m, double far_m);
glm::dmat4 clipFromWorld(const PinholeCamera& camera, double near_m, double far_m);

// A part of a camera's picture, pixels, and the depths along the optical axis that it shows.
struct PictureRegion {
  int x = 0, y = 0, width = 0, height = 0;
  float near_m = 0, far_m = 0;
  bool empty() const { return width == 0; }
};
// Where the points in front of the camera fall, with 8 pixels to spare on each side and a tenth of the depth; empty if
// none falls into the picture.
PictureRegion regionOf(const PinholeCamera& camera, const Positions& positions_in_world);

// A view on a sphere round `target_in_world`, Y up. Azimuth 0 looks at the performer's front (camera on +Z), positive
// azimuth moves the camera towards +X; positive elevation moves it up.
struct OrbitView {
  double azimuth_deg = 0, elevation_deg = 0, distance_m = 3;
  glm::dvec3 target_in_world{0, 0.9, 0};
  double vertical_fov_deg = 35;
};

// The camera of an orbit view for a picture of this size (square pixels, centred principal point).
PinholeCamera cameraFromOrbit(const OrbitView& view, int width, int height);

// The view that stills, turntables and the page start from: vertical field of view 30°, azimuth 25°, elevation 8°,
// target at the centre of the bounds. The distance is the smallest at which the upright cylinder round the bounds stays
// inside a picture of aspect width/height, with 8 % to spare.
OrbitView defaultOrbit(const BoundingBox& bounds, double aspect);

// The same camera for a picture of another size. The narrower field of view is kept, the other is cropped or widened.
PinholeCamera scaledCamera(const PinholeCamera& camera, int width, int height);

// The camera of pictures that were reduced by a whole factor, whose sides are rounded down.
PinholeCamera reducedCamera(const PinholeCamera& camera, int factor);

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
#include "base/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fourdvt {

glm::dvec3 PinholeCamera::centreInWorld() const {
  const glm::dmat3 rotation(cam_from_world);
  return -glm::transpose(rotation) * glm::dvec3(cam_from_world[3]);
}

glm::dvec3 PinholeCamera::forwardInWorld() const {
  const glm::dmat3 rotation(cam_from_world);
  return glm::transpose(rotation) * glm::dvec3(0, 0, 1);
}

glm::dvec3 PinholeCamera::middleRayInWorld() const {
  if (cx == width / 2.0 && cy == height / 2.0) return forwardInWorld();  // exact to the last bit
  const glm::dvec3 in_cam((width / 2.0 - cx) / fx, (height / 2.0 - cy) / fy, 1);
  return glm::normalize(glm::transpose(glm::dmat3(cam_from_world)) * in_cam);
}

glm::dvec3 PinholeCamera::project(const glm::dvec3& point_in_world) const {
  const glm::dvec3 p(cam_from_world * glm::dvec4(point_in_world, 1));
  return {fx * p.x / p.z + cx, fy * p.y / p.z + cy, p.z};
}

PictureRegion regionOf(const PinholeCamera& camera, const Positions& positions) {
  constexpr int kMargin = 8;         // pixels
  constexpr double kNearest = 1e-3;  // m
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  glm::dvec3 low(kInfinity), high(-kInfinity);
  for (const glm::vec3& position : positions) {
    const glm::dvec3 pixel = camera.project(glm::dvec3(position));
    if (pixel.z <= kNearest) continue;
    low = glm::min(low, pixel);
    high = glm::max(high, pixel);
  }
  if (low.z > high.z) return {};
  const auto bound = [](double value, int end) { return static_cast<int>(std::clamp(value, 0.0, double(end))); };
  const int x0 = bound(std::floor(low.x) - kMargin, camera.width),
            x1 = bound(std::ceil(high.x) + kMargin, camera.width),
            y0 = bound(std::floor(low.y) - kMargin, camera.height),
            y1 = bound(std::ceil(high.y) + kMargin, camera.height);
  if (x1 <= x0 || y1 <= y0) return {};
  const double near_m = std::max(0.9 * low.z, kNearest), far_m = 1.1 * high.z;
  return {x0, y0, x1 - x0, y1 - y0, static_cast<float>(near_m), static_cast<float>(far_m)};
}

glm::dmat4 clipFromCam(const PinholeCamera& c, double near_m, double far_m) {
  const double w = c.width, h = c.height;
  glm::dmat4 m(0.0);  // column-major: m[column][row]
  m[0][0] = 2 * c.fx / w;
  m[1][1] = -2 * c.fy / h;
  m[2][0] = 2 * c.cx / w - 1;
  m[2][1] = 1 - 2 * c.cy / h;
  m[2][2] = (far_m + near_m) / (far_m - near_m);
  m[2][3] = 1;
  m[3][2] = -2 * far_m * near_m / (far_m - near_m);
  return m;
}

glm::dmat4 clipFromWorld(const PinholeCamera& camera, double near_m, double far_m) {
  return clipFromCam(camera, near_m, far_m) * camera.cam_from_world;
}

PinholeCamera cameraFromOrbit(const OrbitView& view, int width, int height) {
  constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180.0;
  const double azimuth = view.azimuth_deg * kRadiansPerDegree;
  const double elevation = view.elevation_deg * kRadiansPerDegree;
  const glm::dvec3 outward(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                           std::cos(elevation) * std::cos(azimuth));
  // Derives the axis from the angles rather than a cross product with world up, which is undefined at the poles.
  const glm::dvec3 right(std::cos(azimuth), 0, -std::sin(azimuth));
  const glm::dvec3 forward = -outward;
  const glm::dvec3 down = glm::cross(forward, right);
  const glm::dvec3 eye = view.target_in_world + view.distance_m * outward;
  PinholeCamera camera;
  camera.name = "orbit";
  camera.width = width;
  camera.height = height;
  camera.fy = 0.5 * height / std::tan(0.5 * view.vertical_fov_deg * kRadiansPerDegree);
  camera.fx = camera.fy;
  camera.cx = 0.5 * width;
  camera.cy = 0.5 * height;
  const glm::dmat3 world_from_cam(right, down, forward);
  const glm::dmat3 rotation = glm::transpose(world_from_cam);
  camera.cam_from_world = glm::dmat4(rotation);
  camera.cam_from_world[3] = glm::dvec4(-(rotation * eye), 1);
  return camera;
}

OrbitView defaultOrbit(const BoundingBox& bounds, double aspect) {
  constexpr double kMargin = 1.08;
  OrbitView view;
  view.azimuth_deg = 25;
  view.elevation_deg = 8;
  view.vertical_fov_deg = 30;
  view.target_in_world = 0.5 * (glm::dvec3(bounds.min) + glm::dvec3(bounds.max));
  const glm::dvec3 half = 0.5 * (glm::dvec3(bounds.max) - glm::dvec3(bounds.min));
  const double radius = std::hypot(half.x, half.z);
  const double tan_vertical = std::tan(0.5 * view.vertical_fov_deg * 3.14159265358979323846 / 180.0);
  const double half_angle_horizontal = std::atan(tan_vertical * std::max(aspect, 1e-3));
  const double for_height = half.y / tan_vertical + radius;
  const double for_width = radius / std::sin(half_angle_horizontal);
  view.distance_m = std::max(kMargin * std::max(for_height, for_width), 1e-3);
  return view;
}

PinholeCamera scaledCamera(const PinholeCamera& camera, int width, int height) {
  PinholeCamera scaled = camera;
  const double scale = std::min(double(width) / camera.width, double(height) / camera.height);
  scaled.fx = camera.fx * scale;
  scaled.fy = camera.fy * scale;
  scaled.cx = 0.5 * width + (camera.cx - 0.5 * camera.width) * scale;
  scaled.cy = 0.5 * height + (camera.cy - 0.5 * camera.height) * scale;
  scaled.width = width;
  scaled.height = height;
  return scaled;
}

PinholeCamera reducedCamera(const PinholeCamera& camera, int factor) {
  PinholeCamera out = camera;
  out.width = std::max(1, camera.width / factor), out.height = std::max(1, camera.height / factor);
  const double across = double(out.width) / camera.width, down = double(out.height) / camera.height;
  out.fx *= across, out.cx *= across;
  out.fy *= down, out.cy *= down;
  return out;
}

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
// Ideal shapes and cameras round them: silhouettes with exact coverage, and the true hulls.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <string>
#include <vector>

#include "look_at.h"
#include "reconstruct/polyhedral_hull.h"
#include "silhouette/contour.h"
#include "silhouette/silhouette.h"

namespace fourdvt::reconstruct {

// True if the ray from a point in a unit direction hits the shape.
using Shape = std::function<bool(const glm::dvec3& from, const glm::dvec3& along)>;

inline Shape ballShape(const glm::dvec3& centre, double radius_m) {
  return [=](const glm::dvec3& from, const glm::dvec3& along) {
    const glm::dvec3 to = centre - from;
    const double ahead = glm::dot(to, along);
    return ahead > 0 && glm::dot(to, to) - ahead * ahead <= radius_m * radius_m;
  };
}

inline Shape boxShape(const glm::dvec3& low, const glm::dvec3& high) {
  return [=](const glm::dvec3& from, const glm::dvec3& along) {
    double enter = 0, leave = 1e9;
    const double *l = &low.x, *h = &high.x, *o = &from.x, *d = &along.x;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (l[axis] - o[axis]) / d[axis], b = (h[axis] - o[axis]) / d[axis];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave;
  };
}

// Torus round the origin in the plane y = 0.
inline Shape torusShape(double ring_m, double tube_m) {
  return [=](const glm::dvec3& from, const glm::dvec3& along) {
    double gone = 0;
    for (int step = 0; step < 200 && gone < 10; ++step) {  // sphere tracing of its distance field
      const glm::dvec3 p = from + gone * along;
      const double distance = std::hypot(std::hypot(p.x, p.z) - ring_m, p.y) - tube_m;
      if (distance < 1e-5) return true;
      gone += distance;
    }
    return false;
  };
}

inline Shape either(Shape a, Shape b) {
  return [=](const glm::dvec3& from, const glm::dvec3& along) { return a(from, along) || b(from, along); };
}

inline PinholeCamera lookingAt(const glm::dvec3& target, const glm::dvec3& from, int width = 320, int height = 240,
                               double focal_px = 300) {
  return testing::lookAt(from, target, width, height, focal_px);
}

inline glm::dvec3 rayInWorld(const PinholeCamera& camera, const glm::dvec2& pixel) {
  const glm::dvec3 ray((pixel.x - camera.cx) / camera.fx, (pixel.y - camera.cy) / camera.fy, 1);
  return glm::normalize(glm::transpose(glm::dmat3(camera.cam_from_world)) * ray);
}

// Share of each pixel that the shape covers; 8 × 8 samples if its corners differ.
inline Image coverageOf(const PinholeCamera& camera, const Shape& shape) {
  constexpr int kSamples = 8;
  Image coverage(camera.width, camera.height, 1);
  const glm::dvec3 from = camera.centreInWorld();
  const glm::dmat3 world_from_cam = glm::transpose(glm::dmat3(camera.cam_from_world));
  const auto hit = [&](double x, double y) {
    const glm::dvec3 ray((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);
    return shape(from, glm::normalize(world_from_cam * ray));
  };
  std::vector<uint8_t> corners;
  for (int y = 0; y <= camera.height; ++y)
    for (int x = 0; x <= camera.width; ++x) corners.push_back(hit(x, y));
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const uint8_t* corner = corners.data() + size_t(y) * (camera.width + 1) + x;
      const int at_corners = corner[0] + corner[1] + corner[camera.width + 1] + corner[camera.width + 2];
      int hits = at_corners == 0 ? 0 : kSamples * kSamples;
      if (at_corners != 0 && at_corners != 4) {
        hits = 0;
        for (int k = 0; k < kSamples * kSamples; ++k)
          hits += hit(x + (k % kSamples + 0.5) / kSamples, y + (k / kSamples + 0.5) / kSamples);
      }
      *coverage.at(x, y) = uint8_t(255 * hits / (kSamples * kSamples));
    }
  return coverage;
}

struct Rig {
  std::vector<PinholeCamera> cameras;
  std::vector<Image> coverages;

  Rig(std::vector<PinholeCamera> cameras_of_rig, const Shape& shape) : cameras(std::move(cameras_of_rig)) {
    for (const PinholeCamera& camera : cameras) coverages.push_back(coverageOf(camera, shape));
  }

  std::vector<silhouette::Silhouette> silhouettes() const {
    std::vector<silhouette::Silhouette> out;
    for (size_t k = 0; k < cameras.size(); ++k) out.push_back({cameras[k], coverages[k]});
    return out;
  }

  std::vector<SilhouetteCone> cones(double tolerance_px) const {
    std::vector<SilhouetteCone> out;
    for (size_t k = 0; k < cameras.size(); ++k)
      out.push_back({cameras[k], silhouette::outlineOf(coverages[k], {tolerance_px})});
    return out;
  }
};

// Six cameras 3 m from the origin, in irregular directions.
inline std::vector<PinholeCamera> sixCameras(int width = 320, int height = 240, double focal_px = 300) {
  std::vector<PinholeCamera> cameras;
  for (int k = 0; k < 6; ++k) {
    const double azimuth = k * 1.047 + 0.1, elevation = 0.25 + 0.15 * (k % 3);
    const glm::dvec3 direction(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                               std::cos(elevation) * std::cos(azimuth));
    cameras.push_back(lookingAt(glm::dvec3(0), 3.0 * direction, width, height, focal_px));
  }
  return cameras;
}

// Cameras on a circle of radius 2 m, .6 m above the origin, named cam00, cam01 …
inline std::vector<PinholeCamera> ringCameras(int count) {
  std::vector<PinholeCamera> cameras;
  for (int k = 0; k < count; ++k) {
    const double azimuth = 2 * 3.14159265358979 * k / count + 0.1;
    cameras.push_back(lookingAt(glm::dvec3(0), {2 * std::sin(azimuth), 0.6, 2 * std::cos(azimuth)}, 240, 240));
    cameras.back().name = "cam0" + std::to_string(k);
  }
  return cameras;
}

// Six cameras on the axes: planes through edges of an upright box are parallel, or meet in common points.
inline std::vector<PinholeCamera> axisCameras() {
  std::vector<PinholeCamera> cameras;
  for (int axis = 0; axis < 3; ++axis)
    for (double sign : {-1.0, 1.0}) {
      glm::dvec3 from(0);
      from[axis] = 3 * sign;
      cameras.push_back(lookingAt(glm::dvec3(0), from));
    }
  return cameras;
}

inline bool evenOddInside(const silhouette::Outline& outline, const glm::dvec2& p) {
  bool inside = false;
  for (const silhouette::Ring& ring : outline.rings)
    for (size_t i = 0; i < ring.size(); ++i) {
      const glm::dvec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
      if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
    }
  return inside;
}

// True if the point lies inside all cameras' polygons.
inline bool conesHold(const std::vector<SilhouetteCone>& cones, const glm::dvec3& point_in_world) {
  return std::all_of(cones.begin(), cones.end(), [&](const SilhouetteCone& cone) {
    const glm::dvec3 pixel = cone.camera.project(point_in_world);
    return pixel.z <= 0 || !evenOddInside(cone.outline, glm::dvec2(pixel));
  });
}

// True if the shape covers the point in all cameras whose pictures contain it.
inline bool shapeHolds(const Rig& rig, const Shape& shape, const glm::dvec3& point_in_world) {
  return std::all_of(rig.cameras.begin(), rig.cameras.end(), [&](const PinholeCamera& camera) {
    const glm::dvec3 pixel = camera.project(point_in_world), from = camera.centreInWorld();
    const bool seen =
        pixel.z > 0 && pixel.x >= 0 && pixel.y >= 0 && pixel.x <= camera.width && pixel.y <= camera.height;
    return !seen || shape(from, glm::normalize(point_in_world - from));
  });
}

// Volume of the rig's hull within ±`half_m` of the origin, from one random point in each of steps³ cells, which avoids
// bias where faces are parallel to cells. Deterministic.
inline double hullVolume(const Rig& rig, const Shape& shape, double half_m, int steps = 60) {
  const double step = 2 * half_m / steps;
  size_t inside = 0;
  std::minstd_rand random(1);
  const auto share = [&] { return (random() - 1) / double(std::minstd_rand::max()); };
  for (int z = 0; z < steps; ++z)
    for (int y = 0; y < steps; ++y)
      for (int x = 0; x < steps; ++x) {
        const double a = share(), b = share(), c = share();
        inside += shapeHolds(rig, shape, glm::dvec3(x + a, y + b, z + c) * step - half_m);
      }
  return double(inside) * step * step * step;
}

// True if the closed mesh encloses the point, by the solid angle of its faces.
inline bool meshHolds(const TriangleMesh& mesh, const glm::dvec3& p) {
  // Plain numbers for speed: tests are compiled without optimisation.
  struct Seen {
    double x, y, z, length;
  };
  std::vector<Seen> vertices;
  vertices.reserve(mesh.positions.size());
  for (const glm::vec3& q : mesh.positions) {
    const double x = q.x - p.x, y = q.y - p.y, z = q.z - p.z;
    vertices.push_back({x, y, z, std::sqrt(x * x + y * y + z * z)});
  }
  double angle = 0;
  const Seen* at = vertices.data();
  for (const glm::uvec3& f : mesh.faces) {
    const Seen &a = at[f.x], &b = at[f.y], &c = at[f.z];
    const double ab = a.x * b.x + a.y * b.y + a.z * b.z, bc = b.x * c.x + b.y * c.y + b.z * c.z,
                 ca = c.x * a.x + c.y * a.y + c.z * a.z;
    const double volume = a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
    angle += std::atan2(volume, a.length * b.length * c.length + ab * c.length + bc * a.length + ca * b.length);
  }
  return angle > 3.14159265;  // half of 2π, as each term is half of a face's angle
}

}  // namespace fourdvt::reconstruct

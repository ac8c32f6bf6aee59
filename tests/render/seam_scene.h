// SPDX-License-Identifier: Apache-2.0
// A capture with an analytic truth: a painted cylinder in front of a green backdrop, filmed from a ring. Its mesh lies
// 15 mm outside the surface, like reconstructed ones, and is cut into three charts: one upright, one turned by 90°, one
// mirrored.
#pragma once

#include <cmath>

#include "quad_scene.h"

namespace fourdvt::testing {

constexpr double kRadius_m = 0.3, kPaintedRadius_m = 0.285, kBottom_m = 0.2, kTop_m = 1.4;
inline const glm::dvec3 kBackdrop{57, 150, 73};

// Colour of the paint: smooth and never green.
inline glm::dvec3 paintAt(const glm::dvec3& p) {
  const double turn = std::atan2(p.x, p.z);
  const double wave = std::sin(3 * turn + 4 * p.y);
  return {150 + 60 * wave, 65 + 20 * std::sin(2 * turn - 5 * p.y), 110 + 50 * std::cos(5 * turn + p.y)};
}

struct Cylinder {
  static constexpr uint32_t kSegments = 48, kRows = 10, kCharts = 3;
  MeshTopology topology;
  Positions positions;

  Cylinder() {
    for (uint32_t row = 0; row <= kRows; ++row)
      for (uint32_t s = 0; s < kSegments; ++s) {
        const double turn = 2 * M_PI * s / kSegments;
        positions.emplace_back(kRadius_m * std::sin(turn), kTop_m + (kBottom_m - kTop_m) * row / kRows,
                               kRadius_m * std::cos(turn));
      }
    topology.vertex_count = uint32_t(positions.size());
    for (uint32_t chart = 0; chart < kCharts; ++chart) addChart(chart);
  }

 private:
  void addChart(uint32_t chart) {
    constexpr uint32_t kWide = kSegments / kCharts;
    constexpr double kUvPerMetre = 0.45;
    const uint32_t first_uv = uint32_t(topology.uvs.size());
    for (uint32_t row = 0; row <= kRows; ++row)
      for (uint32_t s = 0; s <= kWide; ++s) {
        const double across = 2 * M_PI * kRadius_m * s / kSegments * kUvPerMetre;
        const double down = (kTop_m - kBottom_m) * row / kRows * kUvPerMetre;
        if (chart == 0) topology.uvs.emplace_back(0.03 + across, 0.03 + down);
        if (chart == 1) topology.uvs.emplace_back(0.03 + down, 0.62 + across);
        if (chart == 2) topology.uvs.emplace_back(0.643 - across, 0.03 + down);
      }
    for (uint32_t row = 0; row < kRows; ++row)
      for (uint32_t s = 0; s < kWide; ++s) {
        const auto vertex = [&](uint32_t r, uint32_t c) { return r * kSegments + (chart * kWide + c) % kSegments; };
        const auto uv = [&](uint32_t r, uint32_t c) { return first_uv + r * (kWide + 1) + c; };
        topology.face_vertices.push_back({vertex(row, s), vertex(row + 1, s), vertex(row, s + 1)});
        topology.face_uvs.push_back({uv(row, s), uv(row + 1, s), uv(row, s + 1)});
        topology.face_vertices.push_back({vertex(row, s + 1), vertex(row + 1, s), vertex(row + 1, s + 1)});
        topology.face_uvs.push_back({uv(row, s + 1), uv(row + 1, s), uv(row + 1, s + 1)});
      }
  }
};

// False if the ray misses the cylinder.
inline bool hitCylinder(const glm::dvec3& eye, const glm::dvec3& ray, glm::dvec3& point) {
  const double a = ray.x * ray.x + ray.z * ray.z, b = eye.x * ray.x + eye.z * ray.z,
               c = eye.x * eye.x + eye.z * eye.z - kPaintedRadius_m * kPaintedRadius_m, root = b * b - a * c;
  if (root < 0) return false;
  point = eye + ray * ((-b - std::sqrt(root)) / a);
  return point.y >= kBottom_m && point.y <= kTop_m;
}

// Picture as filmed: colours mixed with the backdrop where the matte is soft, 4 × 4 rays per pixel.
inline Image filmCylinder(const PinholeCamera& camera) {
  Image image(camera.width, camera.height, 4);
  const glm::dvec3 eye = camera.centreInWorld();
  const glm::dmat3 world_from_cam = glm::transpose(glm::dmat3(camera.cam_from_world));
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      glm::dvec3 sum(0), point;
      int hits = 0;
      for (int k = 0; k < 16; ++k) {
        const double px = x + (k % 4 + 0.5) / 4, py = y + (k / 4 + 0.5) / 4;
        const glm::dvec3 ray =
            world_from_cam * glm::dvec3((px - camera.cx) / camera.fx, (py - camera.cy) / camera.fy, 1);
        const bool hit = hitCylinder(eye, ray, point);
        hits += hit;
        sum += hit ? paintAt(point) : kBackdrop;
      }
      for (int c = 0; c < 3; ++c) image.at(x, y)[c] = static_cast<uint8_t>(sum[c] / 16 + 0.5);
      image.at(x, y)[3] = static_cast<uint8_t>(hits * 255 / 16);
    }
  return image;
}

}  // namespace fourdvt::testing

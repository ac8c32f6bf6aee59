// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/rig.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "base/text.h"
#include "capture/capture.h"
#include "lab/studio/random.h"
#include "platform/files.h"

namespace fourdvt::studio {
namespace {

constexpr double kElevation_deg = 12, kFieldOfView_deg = 30, kMargin = 0.04;

struct Direction {
  double azimuth_deg, elevation_deg;
};

PinholeCamera cameraAt(const Direction& direction, const OrbitView& start, int width, int height) {
  OrbitView view = start;
  view.azimuth_deg = direction.azimuth_deg;
  view.elevation_deg = direction.elevation_deg;
  return cameraFromOrbit(view, width, height);
}

bool seesAll(const PinholeCamera& camera, const BoundingBox& box) {
  for (int k = 0; k < 8; ++k) {
    const glm::dvec3 corner(k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y,
                            k & 4 ? box.max.z : box.min.z);
    const glm::dvec3 p = camera.project(corner);
    const double x = p.x / camera.width, y = p.y / camera.height;
    if (p.z <= 0 || x < kMargin || x > 1 - kMargin || y < kMargin || y > 1 - kMargin) return false;
  }
  return true;
}

std::string numbered(const char* stem, size_t number) { return printed("%s%02zu", stem, number); }

}  // namespace

Rig makeRig(const BoundingBox& bounds, int cameras, int width, int height) {
  OrbitView view = defaultOrbit(bounds, double(width) / height);
  view.vertical_fov_deg = kFieldOfView_deg;
  view.distance_m *= 0.5;
  const double step = 360.0 / cameras;
  std::vector<Direction> ring,
      test{{0.5 * step, kElevation_deg}, {1.5 * step, kElevation_deg + 4}, {-0.35 * step, kElevation_deg + 16}};
  for (int c = 0; c < cameras; ++c) ring.push_back({c * step, kElevation_deg});
  Rig rig;
  for (bool inside = false; !inside; view.distance_m *= 1.01) {
    rig.ring.clear();
    rig.test.clear();
    inside = true;
    for (const Direction& d : ring) rig.ring.push_back(cameraAt(d, view, width, height));
    for (const Direction& d : test) rig.test.push_back(cameraAt(d, view, width, height));
    for (const auto* list : {&rig.ring, &rig.test})
      for (const PinholeCamera& camera : *list) inside &= seesAll(camera, bounds);
    rig.near_m = 0.1 * view.distance_m;
    rig.far_m = 4 * view.distance_m;
  }
  for (size_t c = 0; c < rig.ring.size(); ++c) rig.ring[c].name = numbered("cam", c);
  for (size_t c = 0; c < rig.test.size(); ++c) rig.test[c].name = numbered("test", c);
  return rig;
}

std::vector<PinholeCamera> miscalibrated(const std::vector<PinholeCamera>& truth, const StudioKnobs& knobs) {
  std::vector<PinholeCamera> out = truth;
  for (size_t c = 0; c < out.size(); ++c) {
    PinholeCamera& camera = out[c];
    const auto normal = [&](int k) { return randomNormal(knobs.seed, 0x0ca0000 + 16 * c + k); };
    const glm::dvec3 turn = knobs.rotation_deg * std::numbers::pi / 180 * glm::dvec3(normal(0), normal(1), normal(2));
    const glm::dvec3 centre =
        camera.centreInWorld() + 1e-3 * knobs.translation_mm * glm::dvec3(normal(3), normal(4), normal(5));
    const double angle = glm::length(turn);
    glm::dmat3 rotation(camera.cam_from_world);
    if (angle > 0) rotation = glm::dmat3(glm::mat3_cast(glm::angleAxis(angle, turn / angle))) * rotation;
    camera.cam_from_world = glm::dmat4(rotation);
    camera.cam_from_world[3] = glm::dvec4(-(rotation * centre), 1);
    camera.fx *= 1 + 0.01 * knobs.focal_percent * normal(6);
    camera.fy = camera.fx;
  }
  return out;
}

std::vector<PinholeCamera> plateCameras(const std::vector<PinholeCamera>& ring, const StudioKnobs& knobs) {
  std::vector<PinholeCamera> out = ring;
  if (knobs.plate_move_pixels == 0) return out;
  for (size_t c = 0; c < out.size(); ++c) {
    PinholeCamera& camera = out[c];
    const auto share = [&](int k) { return double(randomBits(knobs.seed, 0x91a7e000 + 8 * c + k) >> 40) / (1 << 24); };
    const double pixels = knobs.plate_move_pixels, towards = 2 * std::numbers::pi * share(0);
    const double corner = std::hypot(camera.width, camera.height) / 2, side = share(1) < 0.5 ? -1 : 1;
    const glm::dvec3 turn(-pixels / camera.fy * std::sin(towards), pixels / camera.fx * std::cos(towards),
                          side * pixels / (3 * corner));
    const glm::dvec3 moved = 2e-4 * pixels * glm::normalize(glm::dvec3(share(2), share(3), share(4)) - 0.5);
    const double angle = glm::length(turn);
    const glm::dmat3 rotation = glm::dmat3(glm::mat3_cast(glm::angleAxis(angle, turn / angle)));
    camera.cam_from_world = glm::dmat4(rotation) * camera.cam_from_world;
    camera.cam_from_world[3] += glm::dvec4(moved, 0);
  }
  return out;
}

Status writeColmap(const std::string& folder, std::span<const PinholeCamera> cameras, double scale,
                   const std::array<double, 3>& lens) {
  FOURDVT_TRY(platform::makeFolder(folder));
  std::vector<capture::CaptureCamera> pinholes;
  for (const PinholeCamera& camera : cameras)
    pinholes.push_back({camera, {.k1 = lens[0], .k2 = lens[1], .k3 = lens[2]}});
  const capture::ColmapText text = capture::colmapText(pinholes, 1 / scale);
  FOURDVT_TRY(platform::writeFileAtomic(folder + "/cameras.txt", text.cameras));
  return platform::writeFileAtomic(folder + "/images.txt", text.images);
}

}  // namespace fourdvt::studio

// SPDX-License-Identifier: Apache-2.0
// A ball in front of six cameras, as a live stage captures it: outlines, and JPEGs in which ball and room have one
// colour each.
#pragma once

#include <filesystem>

#include "live/protocol/camera_messages.h"
#include "live/rig/rig.h"
#include "platform/files.h"
#include "silhouette_fixture.h"

namespace fourdvt::live {

constexpr double kBall_m = 0.5;
constexpr uint8_t kBallColour[3] = {200, 120, 60}, kRoomColour[3] = {40, 90, 160};

inline std::vector<Ring16> ringsOf(const silhouette::Outline& outline) {
  std::vector<Ring16> out;
  for (const silhouette::Ring& ring : outline.rings) {
    out.emplace_back();
    for (const glm::dvec2& p : ring)
      out.back().push_back(
          {uint16_t(std::lround(p.x * kPointsPerPixel)), uint16_t(std::lround(p.y * kPointsPerPixel))});
  }
  return out;
}

inline Rig ballRig() {
  Rig rig;
  rig.path = "rig.json", rig.folder = ".", rig.name = "ball";
  rig.bounds = {glm::vec3(-0.9f), glm::vec3(0.9f)};
  rig.ground_y_m = -0.5;
  int number = 0;
  for (PinholeCamera& camera : reconstruct::sixCameras()) {
    camera.name = "cam0" + std::to_string(number++);
    rig.cameras.push_back({{camera, {}}, {camera, {}}, std::nullopt});
  }
  return rig;
}

inline std::vector<uint8_t> jpegOf(const Image& rgb, int quality = 95) {
  const std::string path = (std::filesystem::temp_directory_path() / "fourdvt_live_test.jpg").string();
  if (!platform::writeImage(path, rgb, quality).ok()) return {};
  auto bytes = platform::readFile(path);
  std::filesystem::remove(path);
  return bytes.ok() ? bytes.take() : std::vector<uint8_t>();
}

// Message of a camera that sees the ball at `centre`, wholly or partly; without a time.
inline CameraPicture ballPicture(const PinholeCamera& camera, double tolerance_px = 1,
                                 const glm::dvec3& centre = glm::dvec3(0), package::Rect crop = {}) {
  const Image coverage = reconstruct::coverageOf(camera, reconstruct::ballShape(centre, kBall_m));
  CameraPicture out;
  out.rings = ringsOf(silhouette::outlineOf(coverage, {tolerance_px}));
  out.crop = crop.width > 0 ? crop : package::Rect{0, 0, camera.width, camera.height};
  Image rgb(out.crop.width, out.crop.height, 3);
  for (int y = 0; y < rgb.height; ++y)
    for (int x = 0; x < rgb.width; ++x) {
      const double ball = *coverage.at(out.crop.x + x, out.crop.y + y) / 255.0;
      for (int c = 0; c < 3; ++c)
        rgb.at(x, y)[c] = uint8_t(std::lround(ball * kBallColour[c] + (1 - ball) * kRoomColour[c]));
    }
  out.jpeg = jpegOf(rgb);
  return out;
}

}  // namespace fourdvt::live

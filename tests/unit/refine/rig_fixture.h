// SPDX-License-Identifier: Apache-2.0
// A figure of balls that swings in front of a ring of cameras: analytic silhouettes at any instant.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "refine/silhouettes/rig_fit.h"

namespace fourdvt::refine {

constexpr int kRigPicture = 200, kRigFrames = 16;
constexpr double kRigFocal = 560;

// Eight cameras on a ring that look slightly down and up in turn.
inline std::vector<PinholeCamera> ringOfCameras(int count = 8) {
  std::vector<PinholeCamera> out;
  for (int c = 0; c < count; ++c) {
    out.push_back(cameraFromOrbit({.azimuth_deg = 360.0 * c / count,
                                   .elevation_deg = c % 2 ? 12.0 : -8.0,
                                   .distance_m = 4,
                                   .target_in_world = {0, 0, 0}},
                                  kRigPicture, kRigPicture));
    out.back().fx = out.back().fy = kRigFocal;
    out.back().name = "cam0" + std::to_string(c);
  }
  return out;
}

// Coverage by the balls' cones, with half angle asin(radius / distance) each.
inline Image silhouetteOf(const PinholeCamera& camera, double instant) {
  const double a = 0.11 * instant, b = 0.07 * instant + 1;
  struct Ball {
    glm::dvec3 centre;
    double radius;
    glm::dvec3 towards{0};  // from the camera
    double half_angle = 0, near_cosine = 1;
  };
  Ball balls[] = {{{0, 0, 0}, 0.22},
                  {{0.4 * std::cos(a), 0.3, 0.4 * std::sin(a)}, 0.1},
                  {{0.3 * std::sin(b), -0.4, 0.3 * std::cos(b)}, 0.12},
                  {{0.1, 0.35 + 0.1 * std::sin(a), -0.1}, 0.1},
                  {{-0.35, 0.35 * std::sin(b), 0.1}, 0.09}};
  const glm::dmat4 world_from_cam = glm::inverse(camera.cam_from_world);
  const glm::dvec3 eye = camera.centreInWorld();
  for (Ball& ball : balls) {
    const glm::dvec3 to = ball.centre - eye;
    ball.towards = glm::normalize(to);
    ball.half_angle = std::asin(ball.radius / glm::length(to));
    ball.near_cosine = std::cos(ball.half_angle + 1 / camera.fx);  // no coverage beyond this angle
  }
  Image out(camera.width, camera.height, 1);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const glm::dvec3 ray =
          glm::normalize(glm::dmat3(world_from_cam) *
                         glm::dvec3((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1));
      double inside = -1e9;
      for (const auto& ball : balls) {
        const double cosine = glm::dot(ray, ball.towards);
        if (cosine < ball.near_cosine) continue;
        inside = std::max(inside, camera.fx * (ball.half_angle - std::acos(std::min(cosine, 1.0))));
      }
      *out.at(x, y) = uint8_t(std::lround(255 * std::clamp(inside + 0.5, 0.0, 1.0)));
    }
  return out;
}

// Picture k of camera c shows the instant k − offset_frames[c].
inline SilhouetteClip filmed(const std::vector<PinholeCamera>& cameras, const std::vector<double>& offset_frames) {
  SilhouetteClip clip(cameras, false);
  for (int k = 0; k < kRigFrames; ++k) {
    std::vector<Image> pictures;
    for (size_t c = 0; c < cameras.size(); ++c) pictures.push_back(silhouetteOf(cameras[c], k - offset_frames[c]));
    clip.add(pictures);
  }
  return clip;
}

inline double degreesApart(const PinholeCamera& a, const PinholeCamera& b) {
  const glm::dmat3 turn = glm::dmat3(a.cam_from_world) * glm::transpose(glm::dmat3(b.cam_from_world));
  const double trace = turn[0][0] + turn[1][1] + turn[2][2];
  return 180 / 3.14159265358979323846 * std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0));
}

}  // namespace fourdvt::refine

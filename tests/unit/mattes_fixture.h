// SPDX-License-Identifier: Apache-2.0
// Balls in a noisy room, filmed by a ring of cameras: pictures, plates and true masks for mattes of several cameras.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/image.h"
#include "capture/capture.h"
#include "look_at.h"

namespace fourdvt::mattes {

constexpr int kSide = 160;  // pixels

struct Ball {
  glm::dvec3 centre{0};
  double radius_m = 0.4;
  std::array<int, 3> colour{190, 80, 60};
  double stripes = 25;  // levels: a pattern fixed to the ball
};

// `count` cameras, 1.2 m above the origin on a ring of radius 3 m, with square pictures; the floor lies at y = -0.5.
inline std::vector<capture::CaptureCamera> ringOf(int count, int side = kSide) {
  std::vector<capture::CaptureCamera> out;
  for (int k = 0; k < count; ++k) {
    const double azimuth = 2 * 3.14159265358979 * k / count + 0.2;
    PinholeCamera c = testing::lookAt({3 * std::sin(azimuth), 1.2, 3 * std::cos(azimuth)}, {0, 0, 0}, side, side,
                                      190.0 * side / kSide);
    c.name = "cam0" + std::to_string(k);
    out.push_back({c, {}});
  }
  return out;
}

// Deterministic value between 0 and 1.
inline double hashed(uint32_t a, uint32_t b, uint32_t c) {
  uint32_t h = a * 0x9e3779b1u ^ (b + 0x7f4a7c15u) * 0x85ebca6bu ^ (c + 0x165667b1u) * 0xc2b2ae35u;
  h ^= h >> 15, h *= 0x2c1b3c6du, h ^= h >> 12, h *= 0x297a2d39u, h ^= h >> 15;
  return h / 4294967296.0;
}

inline glm::dvec3 rayOf(const PinholeCamera& camera, double x, double y) {
  const glm::dvec3 ray((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);
  return glm::normalize(glm::transpose(glm::dmat3(camera.cam_from_world)) * ray);
}

// Distance to the ball along the ray; negative if it misses.
inline double hitOf(const Ball& ball, const glm::dvec3& from, const glm::dvec3& along) {
  const glm::dvec3 to = ball.centre - from;
  const double ahead = glm::dot(to, along), apart2 = glm::dot(to, to) - ahead * ahead;
  return ahead > 0 && apart2 < ball.radius_m * ball.radius_m ? ahead - std::sqrt(ball.radius_m * ball.radius_m - apart2)
                                                             : -1;
}

// Levels of the empty room in camera number `camera`. Each channel is 8 levels darker than the previous one.
constexpr double kChannelStep = 8;
inline double roomLevel(int camera, int x, int y, int channel) {
  return 110 + 40 * std::sin(0.11 * x + camera) * std::cos(0.07 * y) + 12 * std::sin(0.9 * x + 0.7 * y) -
         kChannelStep * channel;
}

// Recorded RGB picture with sensor noise of 2 levels; `shot` seeds the noise.
inline Image filmed(const std::vector<capture::CaptureCamera>& rig, int camera, const std::vector<Ball>& balls,
                    uint32_t shot) {
  const PinholeCamera& c = rig[size_t(camera)].pinhole;
  Image out(c.width, c.height, 3);
  const glm::dvec3 from = c.centreInWorld();
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; ++x) {
      const glm::dvec3 along = balls.empty() ? glm::dvec3(0) : rayOf(c, x + 0.5, y + 0.5);
      const Ball* front = nullptr;
      double nearest = 1e9;
      for (const Ball& ball : balls)
        if (const double t = hitOf(ball, from, along); t > 0 && t < nearest) nearest = t, front = &ball;
      double stripes = 0;
      if (front) {
        const glm::dvec3 on = (from + nearest * along - front->centre) / front->radius_m;
        stripes = front->stripes * std::sin(9 * on.x + 7 * on.y) * std::cos(8 * on.z);
      }
      const double room = front ? 0 : roomLevel(camera, x, y, 0);
      for (int channel = 0; channel < 3; ++channel) {
        const double level = front ? front->colour[size_t(channel)] + stripes : room - kChannelStep * channel;
        const uint32_t at = uint32_t((y * c.width + x) * 3 + channel);
        const double noise = hashed(at, shot, 1) + hashed(at, shot, 2) + hashed(at, shot, 3) - 1.5;
        out.at(x, y)[channel] = uint8_t(std::clamp(level + 4 * noise, 0.0, 255.0));
      }
    }
  return out;
}

// CV_8U, 255 where the camera sees a ball.
inline cv::Mat maskOf(const capture::CaptureCamera& camera, const std::vector<Ball>& balls) {
  const PinholeCamera& c = camera.pinhole;
  cv::Mat out(c.height, c.width, CV_8U, cv::Scalar(0));
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; ++x)
      for (const Ball& ball : balls)
        if (hitOf(ball, c.centreInWorld(), rayOf(c, x + 0.5, y + 0.5)) > 0) out.at<uint8_t>(y, x) = 255;
  return out;
}

inline double unionShare(const cv::Mat& a, const cv::Mat& b) {  // intersection over union
  return double(cv::countNonZero(a & b)) / std::max(1, cv::countNonZero(a | b));
}

}  // namespace fourdvt::mattes

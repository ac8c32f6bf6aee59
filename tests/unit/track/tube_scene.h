// SPDX-License-Identifier: Apache-2.0
// A textured tube with closed ends among a ring of cameras: pictures of any of its poses, with exact correspondence.
#pragma once

#include <cmath>
#include <functional>
#include <glm/gtc/constants.hpp>
#include <vector>

#include "base/face_buffer.h"
#include "base/image.h"
#include "base/mesh.h"
#include "track/views.h"

namespace fourdvt::track {

struct TubeScene {
  static constexpr int kAround = 24, kAlong = 40, kSide = 320;
  static constexpr double kLength_m = 0.8, kRadius_m = 0.1;
  std::vector<glm::uvec3> faces;
  Positions rest;
  std::vector<PinholeCamera> cameras;

  TubeScene() {
    for (int i = 0; i < kAlong; ++i)
      for (int k = 0; k < kAround; ++k) {
        const double angle = 2 * glm::pi<double>() * k / kAround, end = std::min(i, kAlong - 1 - i);
        const double radius = kRadius_m * std::sqrt(1 - std::pow(std::max(0.0, 1 - end / 5.0), 2) * 0.96);
        rest.emplace_back(radius * std::cos(angle), kLength_m * i / (kAlong - 1) - kLength_m / 2,
                          radius * std::sin(angle));
      }
    const auto low = uint32_t(rest.size()), high = low + 1;
    rest.emplace_back(0, -kLength_m / 2 - 0.002, 0);
    rest.emplace_back(0, kLength_m / 2 + 0.002, 0);
    for (uint32_t k = 0; k < kAround; ++k) {
      const uint32_t next = (k + 1) % kAround, last = (kAlong - 1) * kAround;
      faces.emplace_back(low, k, next);
      faces.emplace_back(high, last + next, last + k);
      for (uint32_t i = 0; i + 1 < kAlong; ++i) {
        const uint32_t a = i * kAround + k, b = i * kAround + next;
        faces.emplace_back(a, a + kAround, b);
        faces.emplace_back(b, a + kAround, b + kAround);
      }
    }
    for (int c = 0; c < 6; ++c) cameras.push_back(cameraFromOrbit({60.0 * c, 10, 2.2, {0, 0, 0}, 32}, kSide, kSide));
  }

  // Smooth noise on the rest pose, levels.
  static double texture(const glm::dvec3& p) {
    double sum = 0;
    for (int octave = 0; octave < 3; ++octave) {
      const double f = 30 * std::pow(2.0, octave);
      sum += std::sin(f * p.x + 3 * std::sin(0.7 * f * p.y)) * std::sin(f * p.y + 2 * std::cos(0.6 * f * p.z)) *
             std::sin(f * p.z + octave + 2 * std::sin(0.8 * f * p.x)) / std::pow(1.3, octave);
    }
    return 128 + 55 * sum;
  }

  Image picture(const PinholeCamera& camera, const Positions& positions) const {
    Image out(camera.width, camera.height, 4);
    const FaceBuffer buffer = rasterise(camera, faces, positions, 1);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const uint32_t face = buffer.face[size_t(y) * size_t(camera.width) + size_t(x)];
        ProjectedFace projected;
        double w[3];
        if (face == FaceBuffer::kNoFace || !projectFace(camera, faces[face], positions, 1, projected) ||
            !projected.barycentric({x + 0.5, y + 0.5}, w))
          continue;
        glm::dvec3 at(0);
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
          w[k] *= projected.inverse_depth[k];
          at += w[k] * glm::dvec3(rest[faces[face][k]]);
          sum += w[k];
        }
        const auto level = uint8_t(std::clamp(texture(at / sum), 0.0, 255.0));
        uint8_t* pixel = out.at(x, y);
        pixel[0] = pixel[1] = pixel[2] = level;
        pixel[3] = 255;
      }
    return out;
  }

  std::vector<View> views(const Positions& positions) const {
    std::vector<Image> pictures;
    for (const PinholeCamera& camera : cameras) pictures.push_back(picture(camera, positions));
    return viewsOf(cameras, pictures, 16);
  }

  Positions moved(const std::function<glm::dvec3(const glm::dvec3&)>& motion) const {
    Positions out;
    for (const glm::vec3& p : rest) out.emplace_back(motion(p));
    return out;
  }
};

inline glm::dvec3 turnedAboutY(const glm::dvec3& p, double angle_rad) {
  return {std::cos(angle_rad) * p.x + std::sin(angle_rad) * p.z, p.y,
          std::cos(angle_rad) * p.z - std::sin(angle_rad) * p.x};
}

}  // namespace fourdvt::track

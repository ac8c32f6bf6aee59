// SPDX-License-Identifier: Apache-2.0
// A camera's radial lens: pictures as filmed through it, from finer and larger pinhole pictures. The inverse of what
// capture/undistort.h removes. Without coefficients it changes nothing.
#pragma once

#include <array>

#include "base/camera.h"
#include "base/image.h"
#include "base/result.h"

namespace fourdvt::studio {

class Lens {
 public:
  Lens() = default;  // none
  // Coefficients k1, k2, k3 of capture::Distortion. Errors: InvalidArgument if the lens images a corner of the filmed
  // picture nowhere, or two places as one, or from beyond kMostEnlarged times the picture.
  static Result<Lens> create(const std::array<double, 3>& coefficients, const PinholeCamera& camera);

  bool any() const { return k_ != std::array<double, 3>{}; }
  // The pixel of the pinhole's picture that is imaged at this pixel of the filmed one.
  glm::dvec2 pinholePixel(const PinholeCamera& camera, const glm::dvec2& filmed_pixel) const;
  // The pinhole camera, of the same place, whose picture filmed() takes: it shows all that the lens does.
  PinholeCamera drawn(const PinholeCamera& camera) const;
  // The recording of the drawn picture by `camera`, any number of channels: kFiner² samples a pixel.
  Image filmed(const PinholeCamera& camera, const Image& drawn_picture) const;

  static constexpr int kFiner = 2;
  static constexpr double kMostEnlarged = 2;

 private:
  explicit Lens(const std::array<double, 3>& coefficients) : k_(coefficients) {}
  double imagedAt(double r) const;
  double slopeAt(double r) const;
  double radiusOf(double imaged) const;

  std::array<double, 3> k_{};
  glm::ivec2 margin_{0};  // pixels of the pinhole's picture beyond the filmed one's, on each side
};

}  // namespace fourdvt::studio

// SPDX-License-Identifier: Apache-2.0
// Radial lens distortion of a camera: distorts finer and larger pinhole pictures. Inverse of capture/undistort.h.
// Without coefficients it is the identity.
#pragma once

#include <array>

#include "base/camera.h"
#include "base/image.h"
#include "base/result.h"

namespace fourdvt::studio {

class Lens {
 public:
  Lens() = default;  // none
  // Coefficients k1, k2, k3 of capture::Distortion. Errors: InvalidArgument if the lens has no image for a corner of
  // the filmed picture, maps two places to one, or requires a pinhole picture above kMaxEnlarged times the filmed one.
  static Result<Lens> create(const std::array<double, 3>& coefficients, const PinholeCamera& camera);

  bool any() const { return k_ != std::array<double, 3>{}; }
  // Pixel of the pinhole picture imaged at this pixel of the filmed one.
  glm::dvec2 pinholePixel(const PinholeCamera& camera, const glm::dvec2& filmed_pixel) const;
  // Pinhole camera, of the same pose, for the input picture of filmed(): covers the lens's whole field of view.
  PinholeCamera drawn(const PinholeCamera& camera) const;
  // Distorts the drawn picture to the recording of `camera`, any number of channels: kFiner² samples a pixel.
  Image filmed(const PinholeCamera& camera, const Image& drawn_picture) const;

  static constexpr int kFiner = 2;
  static constexpr double kMaxEnlarged = 2;

 private:
  explicit Lens(const std::array<double, 3>& coefficients) : k_(coefficients) {}
  double imagedAt(double r) const;
  double slopeAt(double r) const;
  double radiusOf(double imaged) const;

  std::array<double, 3> k_{};
  glm::ivec2 margin_{0};  // pixels of the pinhole's picture beyond the filmed one's, on each side
};

}  // namespace fourdvt::studio

// SPDX-License-Identifier: Apache-2.0
// Projection formulas of the formats' documentation, reimplemented for the tests: pixel of a world point.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "capture/import/readers.h"
#include "capture/undistort.h"
#include "capture_fixture.h"

namespace fourdvt::capture {

using Rows = std::array<double, 9>;  // 3 × 3 matrix, row by row
using Vector = std::array<double, 3>;

// OpenCV's formula: R = cos θ I + (1 − cos θ) k kᵀ + sin θ [k]×.
inline Rows rodrigues(const Vector& r) {
  const double angle = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
  const double x = r[0] / angle, y = r[1] / angle, z = r[2] / angle, c = std::cos(angle), s = std::sin(angle);
  return {c + (1 - c) * x * x,     (1 - c) * x * y - s * z, (1 - c) * x * z + s * y,
          (1 - c) * x * y + s * z, c + (1 - c) * y * y,     (1 - c) * y * z - s * x,
          (1 - c) * x * z - s * y, (1 - c) * y * z + s * x, c + (1 - c) * z * z};
}

inline Vector times(const Rows& m, const Vector& v) {
  return {m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
          m[6] * v[0] + m[7] * v[1] + m[8] * v[2]};
}

inline Rows transposed(const Rows& m) { return {m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]}; }

inline Vector plus(const Vector& a, const Vector& b, double factor = 1) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}

struct Lens {
  double fx = 0, fy = 0, cx = 0, cy = 0, skew = 0;
  std::array<double, 8> d{};  // k1 k2 p1 p2 k3 k4 k5 k6; fisheye: k1 k2 k3 k4
  bool fisheye = false;
};

// Pixel of a point in front of the camera (x right, y down, z forward).
inline glm::dvec2 throughLens(const Lens& lens, const Vector& point) {
  double x = point[0] / point[2], y = point[1] / point[2];
  const double r2 = x * x + y * y;
  const auto& d = lens.d;
  double xd = 0, yd = 0;
  if (lens.fisheye) {
    const double r = std::sqrt(r2), t = std::atan(r);
    const double td =
        t * (1 + d[0] * std::pow(t, 2) + d[1] * std::pow(t, 4) + d[2] * std::pow(t, 6) + d[3] * std::pow(t, 8));
    xd = td / r * x, yd = td / r * y;
  } else {
    const double ratio =
        (1 + d[0] * r2 + d[1] * r2 * r2 + d[4] * r2 * r2 * r2) / (1 + d[5] * r2 + d[6] * r2 * r2 + d[7] * r2 * r2 * r2);
    xd = x * ratio + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x);
    yd = y * ratio + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y;
  }
  return {lens.fx * xd + lens.skew * yd + lens.cx, lens.fy * yd + lens.cy};
}

inline const std::array<Vector, 3> kPoints{{{0.1, 0.2, 0.3}, {-0.4, 0.3, -0.2}, {0.25, -0.5, 0.15}}};

// Expects the camera to image points of the file's world as `in_camera` and the lens do, shifted by `first_pixel`; also
// after writing and reading it as COLMAP text.
template <class InCamera>
void expectImages(const ImportedCamera& imported, const Lens& lens, double first_pixel, InCamera in_camera,
                  double unit = 1) {
  CaptureCamera camera = imported.camera;
  if (camera.pinhole.width == 0) camera.pinhole.width = camera.pinhole.height = 100;
  const ColmapText text = colmapText({camera}, 1);
  auto again = parseColmapText(text.cameras, text.images, "again");
  ASSERT_TRUE(again.ok()) << again.error().message;
  again.value()[0].distortion.skew = camera.distortion.skew;  // COLMAP has no skew
  for (const Vector& point : kPoints) {
    const Vector world{point[0] * unit, point[1] * unit, point[2] * unit};
    const Vector seen = in_camera(world);
    ASSERT_GT(seen[2], 0) << "the test's point lies behind its camera";
    const glm::dvec2 expected = throughLens(lens, seen) + first_pixel;
    for (const CaptureCamera& c : {camera, again.value()[0]}) {
      const glm::dvec3 pinhole = c.pinhole.project({world[0], world[1], world[2]});
      const glm::dvec2 got = filmedPixel(c, glm::dvec2(pinhole));
      EXPECT_NEAR(got.x, expected.x, 0.01);
      EXPECT_NEAR(got.y, expected.y, 0.01);
    }
  }
}

}  // namespace fourdvt::capture

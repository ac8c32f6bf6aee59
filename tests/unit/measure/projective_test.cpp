// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/projective.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fourdvt::measure {
namespace {

// A square of side 1 m in the plane z = 0 facing +Z, centred on the origin.
const std::vector<glm::uvec3> kSquareFaces{{0, 1, 2}, {0, 2, 3}};
const Positions kSquare{{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}};

PinholeCamera orbit(double azimuth_deg, int side = 64) {
  OrbitView view;
  view.azimuth_deg = azimuth_deg;
  view.target_in_world = glm::dvec3(0);
  view.distance_m = 2;
  view.vertical_fov_deg = 2 * 180 / 3.14159265358979323846 * std::atan(0.5);  // 2 m across at the square
  return cameraFromOrbit(view, side, side);
}

TEST(Projective, SameViewReproducesThePicture) {
  const PinholeCamera camera = orbit(0);
  Image picture(64, 64, 3);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      picture.at(x, y)[0] = static_cast<uint8_t>(3 * x);
      picture.at(x, y)[1] = static_cast<uint8_t>(3 * y);
    }
  const Image out = renderProjective(camera, {&camera, 1}, {&picture, 1}, kSquareFaces, kSquare, {.samples = 1});
  for (int y = 17; y < 47; ++y)
    for (int x = 17; x < 47; ++x) {
      ASSERT_EQ(out.at(x, y)[3], 255);
      ASSERT_NEAR(out.at(x, y)[0], 3 * x, 1);
      ASSERT_NEAR(out.at(x, y)[1], 3 * y, 1);
    }
  EXPECT_EQ(out.at(2, 2)[3], 0);
}

TEST(Projective, WeightsAreThePapersEquations) {
  // Two cameras at azimuth 0 and 60 see flat colours 0 and 255; the centre of the view at azimuth 30 has
  // w0 = cos 0 · cos 30 and w60 = cos 60 · cos 30, so the blend is w60 / (w0 + w60) = 1/3.
  const PinholeCamera cameras[] = {orbit(0, 512), orbit(60, 512)};
  const Image pictures[] = {Image(512, 512, 3, 0), Image(512, 512, 3, 255)};
  const Image out = renderProjective(orbit(30, 65), cameras, pictures, kSquareFaces, kSquare, {.samples = 1});
  EXPECT_NEAR(out.at(32, 32)[0], 255.0 / 3, 1.0);
}

TEST(Projective, OccludedCamerasDoNotContribute) {
  // A small square 0.5 m before the first one hides its centre from camera 0 but not from the oblique view and camera.
  std::vector<glm::uvec3> faces = kSquareFaces;
  Positions positions = kSquare;
  for (const glm::vec3& p : kSquare) positions.push_back(0.2f * p + glm::vec3(0, 0, 0.5f));
  faces.push_back({4, 5, 6});
  faces.push_back({4, 6, 7});
  const PinholeCamera cameras[] = {orbit(0, 512), orbit(50, 512)};
  const Image pictures[] = {Image(512, 512, 3, 0), Image(512, 512, 3, 255)};
  const Image out = renderProjective(orbit(40, 65), cameras, pictures, faces, positions, {.samples = 1});
  EXPECT_EQ(out.at(32, 32)[0], 255);
}

}  // namespace
}  // namespace fourdvt::measure

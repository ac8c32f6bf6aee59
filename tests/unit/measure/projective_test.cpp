// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/projective.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scaled.h"
#include "square_fixture.h"

namespace fourdvt::measure {
namespace {

using testing::kSquare, testing::kSquareFaces, testing::orbit;

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
  // A small square 0.5 m in front hides the centre from camera 0, but not from the oblique view and camera.
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

// A surface 3 cm in front of a person is an occluder; a figurine needs a tolerance far below 1 cm.
TEST(Projective, TheToleranceOfDepthFollowsTheSurfacesSize) {
  const auto picture = [](double scale) {
    std::vector<glm::uvec3> faces = kSquareFaces;
    Positions positions = kSquare;
    for (const glm::vec3& p : kSquare) positions.push_back(0.2f * p + glm::vec3(0, 0, 0.03f));
    faces.push_back({4, 5, 6});
    faces.push_back({4, 6, 7});
    PinholeCamera cameras[] = {orbit(40, 512), orbit(-50, 512)}, view = orbit(75, 129);
    for (PinholeCamera* camera : {&cameras[0], &cameras[1], &view}) *camera = testing::scaled(*camera, scale);
    const Image pictures[] = {Image(512, 512, 3, 0), Image(512, 512, 3, 255)};
    return renderProjective(view, cameras, pictures, faces, testing::scaled(positions, scale), {.samples = 1});
  };
  const Image person = picture(1);
  for (const double scale : {1 / 32.0, 32.0})
    EXPECT_LT(testing::shareThatDiffers(person, picture(scale), 2), 0.002) << scale;
}

}  // namespace
}  // namespace fourdvt::measure

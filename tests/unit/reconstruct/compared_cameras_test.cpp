// SPDX-License-Identifier: Apache-2.0
// Selection of the cameras that stereo compares: neighbours, except those with almost the same view.
#include <gtest/gtest.h>

#include <algorithm>

#include "reconstruct/stereo/stereo_refiner.h"
#include "silhouette_fixture.h"

namespace fourdvt::reconstruct {
namespace {

std::vector<size_t> sorted(std::vector<size_t> values) {
  std::sort(values.begin(), values.end());
  return values;
}

// Cameras in one plane, so that angles are those of the circle.
std::vector<PinholeCamera> flatRing(int count) {
  std::vector<PinholeCamera> out;
  for (int k = 0; k < count; ++k) {
    const double azimuth = 2 * 3.14159265358979 * k / count;
    out.push_back(lookingAt({0, 0, 0}, {2 * std::sin(azimuth), 0, 2 * std::cos(azimuth)}));
  }
  return out;
}

TEST(ComparedCameras, AreTheNextOfAFewAndThoseTwentyDegreesOffOfMany) {
  EXPECT_EQ(sorted(comparedWith(flatRing(8), 0, {})), (std::vector<size_t>{1, 7}));    // 45°
  EXPECT_EQ(sorted(comparedWith(flatRing(16), 0, {})), (std::vector<size_t>{1, 15}));  // 22.5°
  EXPECT_EQ(sorted(comparedWith(flatRing(40), 0, {})), (std::vector<size_t>{3, 37}));  // 9°, 18°, 27°
}

TEST(ComparedCameras, NarrowPairsAreBetterThanNoneAndWideOnesAreNone) {
  std::vector<PinholeCamera> cameras = flatRing(36);  // 10° apart
  cameras.resize(2);
  EXPECT_EQ(comparedWith(cameras, 0, {}), (std::vector<size_t>{1}));
  EXPECT_TRUE(comparedWith(flatRing(3), 0, {}).empty());  // 120°
}

TEST(ComparedCameras, ByTheRaysThroughTheirPicturesMiddles) {
  std::vector<PinholeCamera> cameras = flatRing(8);
  // The same pictures of the origin, by a lens turned 45° aside and shifted back.
  PinholeCamera& shifted = cameras[1];
  const glm::dvec3 from = shifted.centreInWorld();
  shifted = lookingAt({-from.z, 0, from.x}, from);
  const glm::dvec3 p = shifted.project({0, 0, 0});
  shifted.cx += shifted.width / 2.0 - p.x;
  EXPECT_EQ(sorted(comparedWith(cameras, 0, {})), (std::vector<size_t>{1, 7}));
}

}  // namespace
}  // namespace fourdvt::reconstruct

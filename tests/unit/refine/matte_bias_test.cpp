// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "base/robust.h"
#include "refine/outline.h"
#include "sphere_fixture.h"

namespace fourdvt::refine {
namespace {

uint8_t encoded(double linear) {
  const double v = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return uint8_t(std::lround(255 * std::clamp(v, 0.0, 1.0)));
}

// A disc of one colour on another, mixed in linear light, with a matte enlarged by `grown` pixels.
Image disc(double grown, glm::dvec3 figure, glm::dvec3 background) {
  const MatteCrop truth = ballMatte(), matte = ballMatte(grown);
  Image out(kBallPicture, kBallPicture, 4);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const double share = *truth.alpha.at(x, y) / 255.0;
      const glm::dvec3 colour = share * figure + (1 - share) * background;
      for (int c = 0; c < 3; ++c) out.at(x, y)[c] = encoded(colour[c]);
      out.at(x, y)[3] = *matte.alpha.at(x, y);
    }
  return out;
}

TEST(MatteBias, TellsHowFarTheMatteIsFromThePicture) {
  for (const double grown : {-2.0, -1.0, 0.0, 1.0, 1.7}) {
    const auto offsets = matteEdgeOffsets(disc(grown, {0.02, 0.02, 0.1}, {0.1, 0.6, 0.1}), 1);
    ASSERT_GT(offsets.size(), 200u);
    EXPECT_NEAR(quantile(offsets, 0.5), grown, 0.1) << grown;
  }
}

TEST(MatteBias, LinearLightIsHalfAtTheEdgeWhicheverSideIsDark) {
  for (const auto& [figure, background] : {std::pair{0.01, 0.8}, {0.8, 0.01}})
    EXPECT_NEAR(quantile(matteEdgeOffsets(disc(0, glm::dvec3(figure), glm::dvec3(background)), 1), 0.5), 0, 0.1);
}

TEST(MatteBias, NothingIsSaidWithoutContrast) {
  EXPECT_TRUE(matteEdgeOffsets(disc(-1, {0.3, 0.3, 0.3}, {0.31, 0.31, 0.31}), 1).empty());
  EXPECT_TRUE(matteEdgeOffsets(Image(64, 64, 4, 255), 1).empty());
  EXPECT_TRUE(matteEdgeOffsets(Image(4, 4, 4, 0), 1).empty());
}

}  // namespace
}  // namespace fourdvt::refine

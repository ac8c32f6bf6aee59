// SPDX-License-Identifier: Apache-2.0
// The lens against the independent formula that undistorts captures.
#include "lab/studio/lens.h"

#include <gtest/gtest.h>

#include <cmath>

#include "capture/undistort.h"

namespace fourdvt::studio {
namespace {

constexpr std::array<double, 3> kLens{-0.3, 0.12, 0.4};

capture::CaptureCamera camera() {
  return {{"cam00", 120, 160, 250, 260, 61, 78, glm::dmat4(1)}, {.k1 = kLens[0], .k2 = kLens[1], .k3 = kLens[2]}};
}

TEST(StudioLens, InvertsTheCapturesFormula) {
  const auto c = camera();
  const Lens lens = Lens::create(kLens, c.pinhole).take();
  double largest = 0;
  for (int y = 0; y <= 160; y += 8)
    for (int x = 0; x <= 120; x += 8) {
      const glm::dvec2 pinhole = lens.pinholePixel(c.pinhole, {x, y});
      EXPECT_NEAR(glm::distance(capture::filmedPixel(c, pinhole), glm::dvec2(x, y)), 0, 1e-6);
      largest = std::max(largest, glm::distance(pinhole, glm::dvec2(x, y)));
    }
  EXPECT_GT(largest, 2);
}

// A blob of the drawn picture appears at the pixel computed by the formula.
TEST(StudioLens, FilmsMarkersWhereTheFormulaPutsThem) {
  const auto c = camera();
  const Lens lens = Lens::create(kLens, c.pinhole).take();
  const PinholeCamera drawn = lens.drawn(c.pinhole);
  for (const glm::dvec2 marker : {glm::dvec2(10, 12), glm::dvec2(60, 80), glm::dvec2(110, 14), glm::dvec2(20, 148)}) {
    // The marker's pixel of the pinhole camera, in the drawn camera's picture.
    const glm::dvec2 at((marker.x - c.pinhole.cx) / c.pinhole.fx * drawn.fx + drawn.cx,
                        (marker.y - c.pinhole.cy) / c.pinhole.fy * drawn.fy + drawn.cy);
    Image picture(drawn.width, drawn.height, 1);
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const double d = glm::distance(at, glm::dvec2(x + 0.5, y + 0.5));
        *picture.at(x, y) = uint8_t(std::lround(250 * std::exp(-d * d / 18)));
      }
    const Image filmed = lens.filmed(c.pinhole, picture);
    ASSERT_EQ(filmed.width, 120);
    ASSERT_EQ(filmed.height, 160);
    glm::dvec2 sum(0);
    double weight = 0;
    for (int y = 0; y < 160; ++y)
      for (int x = 0; x < 120; ++x) {
        sum += double(*filmed.at(x, y)) * glm::dvec2(x + 0.5, y + 0.5);
        weight += *filmed.at(x, y);
      }
    const glm::dvec2 expected = capture::filmedPixel(c, marker);
    EXPECT_NEAR(glm::distance(sum / weight, expected), 0, 0.05) << marker.x << " " << marker.y;
  }
}

TEST(StudioLens, NoneChangesNothing) {
  const auto c = camera();
  const Lens lens = Lens::create({}, c.pinhole).take();
  EXPECT_FALSE(lens.any());
  EXPECT_EQ(lens.drawn(c.pinhole).width, 120);
  EXPECT_EQ(lens.pinholePixel(c.pinhole, {3, 4}), glm::dvec2(3, 4));
}

TEST(StudioLens, FoldedPicturesAreRefused) {
  // Lens that maps far radii back: radii beyond the picture never enter it, or radii from .25 to .36 decrease and
  // larger ones return.
  for (const std::array<double, 3>& k : {std::array<double, 3>{-3, 0, 0}, {-8, 25, 0}}) {
    const auto folded = Lens::create(k, camera().pinhole);
    ASSERT_FALSE(folded) << k[0];
    EXPECT_EQ(folded.error().id, ErrorId::InvalidArgument);
  }
}

}  // namespace
}  // namespace fourdvt::studio

// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/matte_agreement.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fourdvt::measure {
namespace {

// Square of this side with its upper left corner at (at, at), in a picture of 40 × 40 pixels.
Image square(int side, int at, int channels = 1) {
  Image out(40, 40, channels);
  for (int y = at; y < at + side; ++y)
    for (int x = at; x < at + side; ++x) out.at(x, y)[channels - 1] = 200;
  return out;
}

TEST(MatteAgreement, IsWholeForTheSameMatte) {
  MatteAgreement agreement;
  agreement.add(square(20, 10, 4), square(20, 10));
  EXPECT_EQ(agreement.pictures(), 1u);
  EXPECT_EQ(agreement.iou(), 1);
  EXPECT_EQ(agreement.iouOutsideBand(), 1);
  EXPECT_EQ(agreement.edgeDistance(), 0);
}

TEST(MatteAgreement, LeavesOutTheBandAndMeasuresTheEdge) {
  MatteAgreement near;
  near.add(square(24, 8, 4), square(20, 10));
  EXPECT_NEAR(near.iou(), 400.0 / 576, 1e-12);
  // At each corner the pixel offset by (2, 2) is √8 from the corner pixel: outside the band.
  EXPECT_NEAR(near.iouOutsideBand(), 256.0 / 260, 1e-12);
  // The outer edge has 92 pixels; the inner one 76, each 2 pixels from the outer edge.
  const double sides = 80 * 2, beside = 8 * std::sqrt(5.0), corners = 4 * std::sqrt(8.0);
  EXPECT_NEAR(near.edgeDistance(), (sides + beside + corners + 76 * 2) / (92 + 76), 1e-6);

  MatteAgreement far;
  far.add(square(28, 6, 4), square(20, 10));
  EXPECT_LT(far.iouOutsideBand(), 0.7);
}

TEST(MatteAgreement, AddsUpPixelsAndNotRatios) {
  MatteAgreement both, first, second;
  first.add(square(20, 10, 4), square(20, 10));
  second.add(square(10, 10, 4), square(20, 10));
  both.add(first);
  both.add(second);
  EXPECT_EQ(both.pictures(), 2u);
  EXPECT_NEAR(both.iou(), 500.0 / 800, 1e-12);
}

TEST(MatteAgreement, EmptyMattes) {
  MatteAgreement agreement;
  agreement.add(Image(40, 40, 4), Image(40, 40, 1));
  EXPECT_EQ(agreement.iou(), 1);
  EXPECT_TRUE(std::isnan(agreement.edgeDistance()));
  agreement.add(Image(40, 40, 4), square(20, 10));
  EXPECT_EQ(agreement.iou(), 0);
}

}  // namespace
}  // namespace fourdvt::measure

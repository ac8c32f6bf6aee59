// SPDX-License-Identifier: Apache-2.0
#include "base/mesh.h"

#include <gtest/gtest.h>

namespace fourdvt {
namespace {

TEST(LengthScale, FollowsTheMedianOfTheLongestSides) {
  EXPECT_EQ(longestSide({{1, 0, 0}, {1.5f, -2, 0}, {1, 0, 1}}), 2);
  for (const double person_m : {1.45, 1.8, 2.3, 2.8}) EXPECT_EQ(lengthScale({person_m}), 1) << person_m;
  EXPECT_EQ(lengthScale({0.09}), 1 / 16.0);
  EXPECT_EQ(lengthScale({20}), 8);
  EXPECT_EQ(lengthScale({1.8, 40, 1.7}), 1) << "one frame went wrong";
  EXPECT_EQ(lengthScale({}), 1);
  EXPECT_EQ(lengthScale({0}), 1);
}

}  // namespace
}  // namespace fourdvt

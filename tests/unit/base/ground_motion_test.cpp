// SPDX-License-Identifier: Apache-2.0
#include "base/ground_motion.h"

#include <gtest/gtest.h>

#include <glm/gtc/constants.hpp>

namespace fourdvt {
namespace {

TEST(GroundMotion, SharesAddUp) {
  const GroundMotion whole{0.8, {1.5, -0.4}};
  const glm::dvec3 p(0.3, 1.2, -2);
  glm::dvec3 thirds = p;
  for (int i = 0; i < 3; ++i) thirds = shareOf(whole, 1.0 / 3)(thirds);
  EXPECT_LT(glm::distance(thirds, whole(p)), 1e-12);
  EXPECT_LT(glm::distance(shareOf(whole, -1)(whole(p)), p), 1e-12);
  EXPECT_LT(glm::distance(shareOf({0, {3, 1}}, 0.5)(p), p + glm::dvec3(1.5, 0, 0.5)), 1e-12);
  EXPECT_LT(glm::distance(GroundMotion{glm::half_pi<double>(), {}}(glm::dvec3(0, 0, 1)), glm::dvec3(1, 0, 0)), 1e-12);
}

TEST(GroundMotion, HasTheVelocityOfItsPath) {
  const GroundMotion whole{-0.6, {0.3, 1.2}};
  const glm::dvec3 p(0.4, 1, -0.7);
  for (const double at : {0.0, 0.3, 1.0}) {
    const glm::dvec3 before = shareOf(whole, at - 1e-5)(p), after = shareOf(whole, at + 1e-5)(p);
    EXPECT_LT(glm::distance(velocityAt(whole, shareOf(whole, at)(p)), (after - before) / 2e-5), 1e-6) << at;
  }
  EXPECT_LT(glm::distance(velocityAt({0, {3, 1}}, p), glm::dvec3(3, 0, 1)), 1e-12);
}

}  // namespace
}  // namespace fourdvt

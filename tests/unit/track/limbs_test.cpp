// SPDX-License-Identifier: Apache-2.0
#include "track/limbs.h"

#include <gtest/gtest.h>

#include "implicit_mesh.h"
#include "track/mesh/remesh.h"

namespace fourdvt::testing {
namespace {

using track::Limb;
using track::LimbPair;
using track::limbsOf;
using track::pairedLimbs;

struct Arms {
  glm::vec3 left{0.6f, 1.2f, 0}, right{-0.6f, 1.2f, 0};  // hands
  float stride_m = 0;                                    // left foot to the front, right foot to the back
};

// Trunk, two legs and two arms; the shoulders are at (±0.15, 1.2, 0).
TriangleMesh figureWith(const Arms& arms) {
  const auto trunk = capsule({0, 0.8f, 0}, {0, 1.2f, 0}, 0.16f);
  const auto legs = joint(capsule({0.08f, 0.8f, 0}, {0.15f, 0.06f, arms.stride_m}, 0.06f),
                          capsule({-0.08f, 0.8f, 0}, {-0.15f, 0.06f, -arms.stride_m}, 0.06f));
  const auto both = joint(capsule({0.15f, 1.2f, 0}, arms.left, 0.05f), capsule({-0.15f, 1.2f, 0}, arms.right, 0.05f));
  return meshOf(joint(trunk, joint(legs, both)), {-0.8f, -0.1f, -0.8f}, {0.8f, 2.1f, 0.8f}, 0.025f);
}

double distanceToSegment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const double share = std::clamp(glm::dot(p - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
  return glm::distance(p, glm::mix(a, b, share));
}

// Limb whose tip lies near a point; fails the test where there is none.
size_t limbAt(const TriangleMesh& mesh, const std::vector<Limb>& limbs, const glm::vec3& tip) {
  for (size_t i = 0; i < limbs.size(); ++i)
    if (glm::distance(mesh.positions[limbs[i].tip], tip) < 0.1f) return i;
  ADD_FAILURE() << "no limb at (" << tip.x << ", " << tip.y << ", " << tip.z << ")";
  return 0;
}

TEST(Limbs, EndAtHandsAndFeet) {
  const Arms arms;
  const TriangleMesh mesh = figureWith(arms);
  const auto limbs = limbsOf(mesh, {});
  EXPECT_EQ(limbs.size(), 4u);
  limbAt(mesh, limbs, {0.15f, 0, 0});
  limbAt(mesh, limbs, {-0.15f, 0, 0});
  for (const glm::vec3& hand : {arms.left, arms.right}) {
    const Limb& arm = limbs[limbAt(mesh, limbs, hand)];
    const glm::dvec3 shoulder(std::copysign(0.15, hand.x), 1.2, 0);
    ASSERT_GE(arm.rings.size(), 11u);
    for (size_t k = 2; k < 11; ++k) {
      EXPECT_LT(distanceToSegment(arm.rings[k].middle, shoulder, hand), 0.01) << k;
      EXPECT_NEAR(arm.rings[k].radius_m, 0.05, 0.008) << k;
    }
  }
}

TEST(Limbs, KeepTheirRingsAsTheyMove) {
  const TriangleMesh down = figureWith({{0.3f, 0.8f, 0.2f}, {-0.6f, 1.2f, 0}}),
                     up = figureWith({{0.4f, 1.5f, 0}, {-0.6f, 1.2f, 0}});
  const auto from = limbsOf(down, {}), to = limbsOf(up, {});
  const auto pairs = pairedLimbs(from, to);
  ASSERT_EQ(pairs.size(), 4u);
  const size_t left = limbAt(down, from, {0.3f, 0.8f, 0.2f});
  for (const LimbPair& pair : pairs) {
    if (pair.from == left) {
      EXPECT_EQ(pair.to, limbAt(up, to, {0.4f, 1.5f, 0}));
      continue;
    }
    for (size_t k = 0; k < 9; ++k)
      EXPECT_LT(glm::distance(from[pair.from].rings[k].middle, to[pair.to].rings[k].middle),
                track::LimbOptions{}.step_m);
  }
}

TEST(Limbs, KeepTheirSideWhenFeetHaveSwungPastEachOther) {
  Arms forward, back;
  forward.stride_m = 0.35f, back.stride_m = -0.35f;
  const TriangleMesh before = figureWith(forward), after = figureWith(back);
  const auto from = limbsOf(before, {}), to = limbsOf(after, {});
  const auto pairs = pairedLimbs(from, to);
  ASSERT_EQ(pairs.size(), 4u);
  for (const LimbPair& pair : pairs)
    EXPECT_GT(before.positions[from[pair.from].tip].x * after.positions[to[pair.to].tip].x, 0);
}

TEST(Limbs, WithoutCounterpartStayAlone) {
  const TriangleMesh mesh = figureWith({});
  auto limbs = limbsOf(mesh, {});
  const auto all = limbs;
  limbs.erase(limbs.begin() + std::ptrdiff_t(limbAt(mesh, limbs, {-0.6f, 1.2f, 0})));
  EXPECT_EQ(pairedLimbs(all, limbs).size(), 3u);
}

TEST(Limbs, HaveTheSameCurveOnACoarserMesh) {
  const TriangleMesh mesh = figureWith({});
  const auto limbs = limbsOf(mesh, {});
  const auto coarse = track::remeshed(mesh, {}, {1500, 8});
  ASSERT_TRUE(coarse.ok()) << coarse.error().message;
  const auto there = track::limbsOn(coarse.value().positions, mesh, limbs);
  ASSERT_EQ(there.size(), limbs.size());
  for (size_t i = 0; i < limbs.size(); ++i)
    for (size_t k = 2; k < 9; ++k)
      EXPECT_LT(glm::distance(limbs[i].rings[k].middle, there[i].rings[k].middle), 0.035) << i << " " << k;
}

TEST(Limbs, OfABallAreNone) {
  EXPECT_TRUE(limbsOf(meshOf(ball({}, 0.15f), glm::vec3(-0.2f), glm::vec3(0.2f), 0.03f), {}).empty());
}

}  // namespace
}  // namespace fourdvt::testing

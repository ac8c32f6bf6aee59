// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "bake/motion/hybrid_blend.h"
#include "motion_shapes.h"

namespace fourdvt::bake {
namespace {

NonlinearBlend make(const MeshTopology& topology, const Positions& reference) {
  return NonlinearBlend::create(topology, reference).take();
}

Positions turnedAboutY(const Positions& p, double angle, const glm::vec3& shift) {
  const float c = float(std::cos(angle)), s = float(std::sin(angle));
  Positions out;
  for (const glm::vec3& v : p) out.push_back(glm::vec3(c * v.x + s * v.z, v.y, c * v.z - s * v.x) + shift);
  return out;
}

Positions centred(Positions p) {
  const glm::vec3 mean = meanOf(p);
  for (glm::vec3& v : p) v -= mean;
  return p;
}

TEST(NonlinearBlend, ABendingTubeBendsAlongTheArc) {
  const Tube tube;
  const std::vector<Positions> members = {Tube::bent(0), Tube::bent(2.1)};
  const auto blend = make(tube.topology, members[0]);
  for (float w : {0.25f, 0.5f, 0.75f}) {
    const std::vector<float> weights = {1 - w, w};
    const Positions mixed = blend.blend(members, weights), linear = linearBlend(members, weights);
    EXPECT_LT(largestDistance(centred(mixed), centred(Tube::bent(2.1 * w))), 0.002) << w;
    EXPECT_NEAR(Tube::length(mixed), 1, 0.003);
    EXPECT_LT(Tube::length(linear), 0.96);
  }
}

// Tube whose lower half stays straight, and whose upper half bends to an arc.
Positions halfBent(double angle) {
  Positions out = Tube::bent(0);
  const Positions arc = Tube::bent(2 * angle);
  constexpr size_t half = size_t(Tube::kRings / 2) * Tube::kSides;
  for (size_t v = half; v < out.size(); ++v) out[v] = arc[v - half] + glm::vec3(0, 0.5f, 0);
  return out;
}

TEST(NonlinearBlend, WhatDoesNotTurnStaysInItsPlace) {
  const Tube tube;
  const std::vector<Positions> members = {halfBent(0), halfBent(2)};
  const auto blend = make(tube.topology, members[0]);
  for (float w : {0.05f, 0.5f, 0.8f}) {
    const Positions mixed = blend.blend(members, std::vector<float>{1 - w, w});
    double most = 0;
    for (size_t v = 0; v < size_t(Tube::kRings / 2 - 2) * Tube::kSides; ++v)
      most = std::max(most, double(glm::distance(mixed[v], members[0][v])));
    EXPECT_LT(most, 0.002) << w;
    EXPECT_LT(largestDistance(mixed, halfBent(2 * w)), 0.004) << w;
  }
}

TEST(NonlinearBlend, MembersThemselvesAreExact) {
  const Tube tube;
  const std::vector<Positions> members = {Tube::bent(0), Tube::bent(1.5)};
  const auto blend = make(tube.topology, Tube::bent(0.4));  // any pose is a reference
  EXPECT_LT(largestDistance(blend.blend(members, std::vector<float>{0, 1}), members[1]), 1e-5);
  // Equal members: solves without moving anything.
  const std::vector<Positions> same = {members[1], members[1]};
  EXPECT_LT(largestDistance(blend.blend(same, std::vector<float>{0.5f, 0.5f}), members[1]), 1e-5);
}

TEST(NonlinearBlend, RigidTurnsBlendExactly) {
  const Tube tube;
  const Positions pose = Tube::bent(1);
  for (double angle : {1.2, 3.0}) {
    const std::vector<Positions> members = {pose, turnedAboutY(pose, angle, {2, 0.5f, -1})};
    const auto blend = make(tube.topology, Tube::bent(0));
    const std::vector<float> weights = {0.7f, 0.3f};
    const Positions expected = turnedAboutY(pose, 0.3 * angle, {0, 0, 0});
    EXPECT_LT(largestDistance(centred(blend.blend(members, weights)), centred(expected)), 1e-4) << angle;
  }
}

TEST(NonlinearBlend, ThreeMembersMixTheirTurns) {
  const Tube tube;
  const Positions pose = Tube::bent(1);
  const std::vector<Positions> members = {pose, turnedAboutY(pose, 0.5, {0, 0, 0}), turnedAboutY(pose, 1, {0, 0, 0})};
  const auto blend = make(tube.topology, pose);
  const Positions expected = turnedAboutY(pose, 0.3 * 0.5 + 0.5 * 1, {0, 0, 0});
  const Positions mixed = blend.blend(members, std::vector<float>{0.2f, 0.3f, 0.5f});
  EXPECT_LT(largestDistance(centred(mixed), centred(expected)), 1e-4);
}

TEST(NonlinearBlend, BeyondAHalfTurnNeighboursAgree) {
  // The tube's tip turns by 3.8: beyond π the shortest way would tear the tube.
  const Tube tube;
  const std::vector<Positions> members = {Tube::bent(0), Tube::bent(3.8)};
  const auto blend = make(tube.topology, members[0]);
  const Positions mixed = blend.blend(members, std::vector<float>{0.5f, 0.5f});
  EXPECT_LT(largestDistance(centred(mixed), centred(Tube::bent(1.9))), 0.004);
}

TEST(NonlinearBlend, BadFacesDoNoHarm) {
  Tube tube;
  std::vector<Positions> members = {Tube::bent(0), Tube::bent(2.1)};
  const Positions good = make(tube.topology, members[0]).blend(members, std::vector<float>{0.5f, 0.5f});
  const uint32_t own = tube.topology.vertex_count, lonely = own + 1;
  for (Positions& p : members) p.insert(p.end(), {p[100], glm::vec3(7)});
  auto& faces = tube.topology.face_vertices;
  faces[96] = {48, 48, 48};          // a hole, and a face of one point
  faces.push_back({0, 1, 1});        // an edge
  faces.push_back({30, 31, 43});     // a third face at its edges
  faces.push_back({100, 101, own});  // a vertex in the same place as another
  tube.topology.vertex_count = lonely + 1;
  tube.topology.face_uvs.assign(faces.size(), {0, 1, 2});
  const Positions mixed = make(tube.topology, members[0]).blend(members, std::vector<float>{0.5f, 0.5f});
  for (const glm::vec3& p : mixed) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
  Positions tube_only(mixed.begin(), mixed.end() - 2);
  EXPECT_LT(largestDistance(centred(tube_only), centred(good)), 0.01);
  EXPECT_LT(glm::distance(mixed[lonely], glm::vec3(7)), 1e-4);
  EXPECT_LT(glm::distance(mixed[own], mixed[100]), 0.01);
}

TEST(NonlinearBlend, AMeshWithoutAreaIsRefused) {
  Tube tube;
  const auto blend = NonlinearBlend::create(tube.topology, Positions(tube.topology.vertex_count, glm::vec3(1)));
  ASSERT_FALSE(blend.ok());
  EXPECT_EQ(blend.error().id, ErrorId::MeshTopology);
}

TEST(HybridBlend, LinearErrorOfATurnIsItsSagitta) {
  const Tube tube;
  const std::vector<Positions> members = {Tube::bent(0), turnedAboutY(Tube::bent(0), 1.6, {0, 0, 0})};
  const auto blend = make(tube.topology, members[0]);
  HybridErrors errors({{0, 1, 1}}, HybridMix::Polynomial, 16, 4);
  errors.add(blend, members);
  EXPECT_NEAR(errors.of(1).max_m, Tube::kRadius * (1 - std::cos(0.8)), 1e-4);
}

TEST(HybridBlend, ReferencesAreJoinedAndMoreLeaveLess) {
  const Tube tube;
  const std::vector<Positions> members = {Tube::bent(0), Tube::bent(2.1)};
  const auto blend = make(tube.topology, members[0]);
  for (HybridMix mix : {HybridMix::Straight, HybridMix::Polynomial}) {
    HybridErrors errors({{0, 1, 1}}, mix, 16, 4);
    errors.add(blend, members);
    EXPECT_GT(errors.of(1).max_m, 0.05);
    for (int segments = 2; segments <= 4; ++segments)
      EXPECT_LT(errors.of(segments).max_m, 0.6 * errors.of(segments - 1).max_m) << segments;
    const auto nodes = hybridNodes(true, 4, 16, mix);
    ASSERT_EQ(nodes.size(), 3u);
    for (size_t n = 0; n < 3; ++n) {
      const auto at_node = hybridCoefficients(nodes, 4, mix, nodes[n]);
      for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(at_node[k], k == n ? 1 : 0, 1e-9);
    }
    for (double c : hybridCoefficients(nodes, 4, mix, {0, 1, 0})) EXPECT_NEAR(c, 0, 1e-9);
  }
}

// Bounds the error of the polynomial through the nodes by the product of the distances to all nodes.
TEST(HybridBlend, PolynomialsStrayLeastWithStretchedChebyshevPoints) {
  const auto largestProduct = [](std::span<const Shares> nodes) {
    double largest = 0;
    for (int i = 0; i <= 1000; ++i) {
      double product = 1e-3 * i * (1 - 1e-3 * i);
      for (const Shares& node : nodes) product *= 1e-3 * i - node.y;
      largest = std::max(largest, std::abs(product));
    }
    return largest;
  };
  for (int segments = 3; segments <= 6; ++segments) {
    const auto even = hybridNodes(true, segments, 10'000, HybridMix::Straight);
    auto stretched = hybridNodes(true, segments, 10'000, HybridMix::Polynomial);
    const double least = largestProduct(stretched);
    EXPECT_LT(least, 0.9 * largestProduct(even)) << segments;
    for (Shares& node : stretched)
      for (const double moved : {-0.01, 0.01}) {
        node.y += moved;
        EXPECT_GT(largestProduct(stretched), least) << segments;
        node.y -= moved;
      }
  }
}

TEST(HybridBlend, TrianglesMixTheReferencesRoundAPoint) {
  const auto nodes = hybridNodes(false, 2, 12, HybridMix::Straight);
  ASSERT_EQ(nodes.size(), 3u);
  double sum = 0;  // midway between the three edges' middles
  for (double c : hybridCoefficients(nodes, 2, HybridMix::Straight, Shares(1) / 3.0)) sum += c;
  EXPECT_NEAR(sum, 1, 1e-9);
  for (double c : hybridCoefficients(nodes, 2, HybridMix::Straight, {1, 0, 0})) EXPECT_NEAR(c, 0, 1e-9);
}

}  // namespace
}  // namespace fourdvt::bake

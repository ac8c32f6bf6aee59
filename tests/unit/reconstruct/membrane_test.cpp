// SPDX-License-Identifier: Apache-2.0
// The membrane over gaps of stereo: pits are filled, measured and thin parts stay, nothing leaves the hull.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "reconstruct/stereo/depth_fusion.h"

namespace fourdvt::reconstruct {
namespace {

constexpr float kVoxel_m = 0.005f, kBand_m = 3 * kVoxel_m;
constexpr int kSide = 6;  // blocks along each side; the middle of the grid is the origin of `Field`

// Signed distance, metres, positive inside; argument: metres from the grid's middle.
using Field = std::function<float(const glm::vec3&)>;

glm::vec3 placeOf(const SparseDistance& distance, size_t block, size_t i) {
  const glm::ivec3 voxel = distance.blocks[block].at + glm::ivec3(int(i >> 6), int(i >> 3 & 7), int(i & 7));
  return (glm::vec3(voxel) - float(kSide * kBlock) / 2) * kVoxel_m;
}

SparseDistance sampled(const Field& field) {
  SparseDistance out;
  out.voxel_m = kVoxel_m, out.band_m = kBand_m;
  for (int k = 0; k < kSide * kSide * kSide; ++k) {
    out.blocks.emplace_back().at = kBlock * glm::ivec3(k / (kSide * kSide), k / kSide % kSide, k % kSide);
    for (size_t i = 0; i < out.blocks.back().values.size(); ++i)
      out.blocks.back().values[i] = std::clamp(field(placeOf(out, k, i)), -kBand_m, kBand_m);
  }
  return out;
}

std::vector<BlockValues> trustOf(const SparseDistance& like, const Field& trust) {
  std::vector<BlockValues> out(like.blocks.size());
  for (size_t b = 0; b < out.size(); ++b)
    for (size_t i = 0; i < out[b].size(); ++i) out[b][i] = trust(placeOf(like, b, i));
  return out;
}

// Value at the voxel nearest to a position.
float at(const SparseDistance& distance, const glm::vec3& place) {
  const glm::ivec3 voxel(glm::round(place / kVoxel_m + float(kSide * kBlock) / 2));
  const glm::ivec3 block = voxel / kBlock, in = voxel % kBlock;
  return distance.blocks[(block.x * kSide + block.y) * kSide + block.z].values[in.x * 64 + in.y * 8 + in.z];
}

Field ball(float radius_m) {
  return [=](const glm::vec3& p) { return radius_m - glm::length(p); };
}

// A ball covered by the depth maps, except for a narrow pit of poor evidence down to its centre.
TEST(Membrane, FillsANarrowPit) {
  const float radius = 0.08f;
  const auto inPit = [](const glm::vec3& p) { return p.z > 0 && glm::length(glm::vec2(p)) < 0.008f; };
  const SparseDistance hull = sampled(ball(radius));
  const SparseDistance dug = sampled([&](const glm::vec3& p) { return inPit(p) ? -0.01f : ball(radius)(p); });
  const auto trust = trustOf(hull, [&](const glm::vec3& p) { return inPit(p) ? 0.3f : 1.0f; });
  ASSERT_LT(at(dug, {0, 0, 0.04f}), 0);
  SparseDistance out = dug;
  spanMembrane(hull, trust, {}, out);
  EXPECT_GT(at(out, {0, 0, 0.02f}), 0);
  EXPECT_GT(at(out, {0, 0, 0.04f}), 0);
  // A dent as wide as the ball's radius is no pit.
  SparseDistance flat = sampled([&](const glm::vec3& p) { return std::min(ball(radius)(p), 0.03f - p.z); });
  const SparseDistance before = flat;
  spanMembrane(hull, trustOf(hull, [](const glm::vec3&) { return 1.0f; }), {}, flat);
  for (const float z : {0.025f, 0.035f}) EXPECT_EQ(at(flat, {0, 0, z}) > 0, at(before, {0, 0, z}) > 0) << z;
}

// Without evidence, the ridge of a hull is removed: the surface continues from the measured sides.
TEST(Membrane, FollowsItsSurroundingsWhereNothingIsKnown) {
  const auto hull_field = [](const glm::vec3& p) {  // a roof whose ridge runs along y
    return std::min(0.06f - std::abs(p.x) - p.z, p.z + 0.08f) / std::sqrt(2.0f);
  };
  const SparseDistance hull = sampled(hull_field);
  SparseDistance out = hull;
  const auto trust = trustOf(hull, [](const glm::vec3& p) { return p.z < 0.02f ? 1.0f : 0.0f; });
  spanMembrane(hull, trust, {}, out);
  EXPECT_GT(at(hull, {0, 0, 0.054f}), 0);
  EXPECT_LT(at(out, {0, 0, 0.054f}), 0) << "the ridge is rounded";
  EXPECT_GT(at(out, {0, 0, 0}), 0) << "what is known stays";
  EXPECT_GT(at(out, {0.05f, 0, 0}), 0);
  for (size_t b = 0; b < hull.blocks.size(); ++b)
    for (size_t i = 0; i < hull.blocks[b].values.size(); ++i)
      ASSERT_LE(out.blocks[b].values[i], hull.blocks[b].values[i]);
}

// Without evidence anywhere, or far from any, the hull stays, ridges included.
TEST(Membrane, WithoutEvidenceTheHullStays) {
  const auto roof = [](const glm::vec3& p) {
    return std::min(0.09f - std::abs(p.x) - p.z, p.z + 0.1f) / std::sqrt(2.0f);
  };
  const SparseDistance hull = sampled(roof);
  SparseDistance out = hull;
  spanMembrane(hull, trustOf(hull, [](const glm::vec3&) { return 0.0f; }), {}, out);
  for (size_t b = 0; b < out.blocks.size(); ++b) ASSERT_EQ(out.blocks[b].values, hull.blocks[b].values);
  const int reach = MembraneOptions().reach_voxels;
  spanMembrane(hull, trustOf(hull, [](const glm::vec3& p) { return p.z < -0.06f ? 1.0f : 0.0f; }), {}, out);
  for (float z = -0.06f + float(reach + 1) * kVoxel_m; z < 0.1f; z += kVoxel_m)
    ASSERT_EQ(at(out, {0, 0, z}), at(hull, {0, 0, z})) << z;
}

// A finger that no depth map covers stays as in the hull.
TEST(Membrane, LeavesThinPartsAlone) {
  const SparseDistance hull = sampled([](const glm::vec3& p) { return 0.008f - glm::length(glm::vec2(p)); });
  SparseDistance out = hull;
  spanMembrane(hull, trustOf(hull, [](const glm::vec3&) { return 0.0f; }), {}, out);
  for (size_t b = 0; b < out.blocks.size(); ++b) EXPECT_EQ(out.blocks[b].values, hull.blocks[b].values);
}

TEST(Membrane, WithoutStiffnessNothingChanges) {
  const SparseDistance hull = sampled(ball(0.08f));
  SparseDistance out = sampled(ball(0.05f));
  const SparseDistance before = out;
  spanMembrane(hull, trustOf(hull, [](const glm::vec3&) { return 0.0f; }), {.stiffness = 0}, out);
  for (size_t b = 0; b < out.blocks.size(); ++b) EXPECT_EQ(out.blocks[b].values, before.blocks[b].values);
}

TEST(LevelSet, BlocksOpenAndClose) {
  const SparseDistance all = sampled(ball(0.08f));
  SparseDistance small = all;
  compact(small);
  EXPECT_FALSE(small.inside.empty());
  EXPECT_LT(small.blocks.size() + small.inside.size(), all.blocks.size());
  const SparseDistance open = withValuesInside(small);
  EXPECT_TRUE(open.inside.empty());
  EXPECT_EQ(open.blocks.size(), small.blocks.size() + small.inside.size());
  SparseDistance again = open;
  compact(again);
  EXPECT_EQ(again.blocks.size(), small.blocks.size());
  EXPECT_EQ(again.inside.size(), small.inside.size());
}

}  // namespace
}  // namespace fourdvt::reconstruct

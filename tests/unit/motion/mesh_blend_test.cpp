// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "motion/blend.h"
#include "motion/placement.h"

namespace fourdvt::motion {
namespace {

// Two frames, three members, two references, two vertices; every number differs.
struct Fixture {
  package::StreamIndex index;
  package::ChunkFrames frames{
      .frame_count = 2, .vertex_count = 2, .member_count = 3, .reference_count = 2, .alignment_count = 2};
  Fixture() {
    index.position_origin = {-1, 0, 2};
    index.position_step_m = 0.25f;
    index.alignment_step_m = 0.5f;
    for (int i = 0; i < 12; ++i) frames.positions.emplace_back(i, 10 + i * i, -3 * i);
    for (int i = 0; i < 8; ++i) frames.offsets.emplace_back(100 * i, -i, 7);
    for (int i = 0; i < 8; ++i) frames.alignment.emplace_back(i, -2 * i);
    for (int i = 0; i < 6; ++i) frames.root.emplace_back(i, 0.1f * float(i), 0.01f * float(i));
  }
  glm::vec3 position(int row, int member, int vertex) const {
    return index.position_origin + index.position_step_m * glm::vec3(frames.positions[(row * 3 + member) * 2 + vertex]);
  }
  glm::vec3 correction(int row, int reference, int vertex) const {
    return index.position_step_m * glm::vec3(frames.offsets[(row * 2 + reference) * 2 + vertex]);
  }
};

void expectNear(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-4f) {
  EXPECT_LT(glm::distance(a, b), tolerance) << a.x << " " << a.y << " " << a.z;
}

TEST(MeshBlend, MembersAndCorrectionsOfTheFrameAreSummed) {
  const Fixture f;
  Positions out;
  for (uint32_t row = 0; row < 2; ++row) {
    blendFrame(f.frames, row, f.index, {{0.5f, 0.2f, 0.3f}, {0.25f, 0.75f}}, out);
    ASSERT_EQ(out.size(), 2u);
    for (int v = 0; v < 2; ++v) {
      glm::vec3 expected = 0.5f * f.position(row, 0, v) + 0.2f * f.position(row, 1, v) + 0.3f * f.position(row, 2, v);
      expected += 0.25f * f.correction(row, 0, v) + 0.75f * f.correction(row, 1, v);
      expectNear(out[v], expected);
    }
  }
}

TEST(MeshBlend, OneMemberIsItself) {
  const Fixture f;
  Positions out;
  blendFrame(f.frames, 1, f.index, {{0, 0, 1}, {0, 0}}, out);
  for (int v = 0; v < 2; ++v) expectNear(out[v], f.position(1, 2, v), 1e-6f);
}

TEST(MeshBlend, AlignmentAndRootOfTheFrame) {
  Fixture f;
  std::vector<glm::vec2> alignment;
  alignmentOf(f.frames, 1, f.index, alignment);
  ASSERT_EQ(alignment.size(), 4u);
  EXPECT_EQ(alignment[2], glm::vec2(3, -6));
  expectNear(rootOf(f.frames, 1, std::vector<float>{0, 0.5f, 0.5f}), {4.5f, 0.45f, 0.045f});
  f.frames.alignment_count = 0;
  f.frames.alignment.clear();
  alignmentOf(f.frames, 1, f.index, alignment);
  EXPECT_TRUE(alignment.empty());
}

TEST(MeshBlend, CrossFadeMovesTheSecondMeshFirst) {
  const Placement placement{{3, -1}, 1.57079633f};
  Positions a = {{0, 0, 0}, {1, 1, 1}};
  const Positions b = {{0, 0, 1}, {2, 5, 0}};
  crossFade(a, b, worldFromCharacter(placement), 0.25f);
  expectNear(a[0], {0.25f * 4, 0, 0.25f * -1});  // +z turns towards +x
  expectNear(a[1], {0.75f + 0.25f * 3, 0.75f + 0.25f * 5, 0.75f - 0.25f * 3});
}

TEST(Placement, StepsAreSeenFromTheCharacter) {
  // A quarter turn towards +x, then two metres ahead.
  Placement placement = moved({{1, 1}, 0}, {0, 0, 1.57079633f});
  placement = moved(placement, {0, 2, 0});
  EXPECT_NEAR(placement.ground_m.x, 3, 1e-5);
  EXPECT_NEAR(placement.ground_m.y, 1, 1e-5);
}

TEST(Placement, StepsBetweenRootsAddUpToTheRoot) {
  // A walk round a circle: root values as seen from frame 0.
  Placement walked;
  glm::vec3 before(0);
  for (int i = 1; i <= 40; ++i) {
    const float angle = 0.1f * float(i);
    const glm::vec3 root(2 * (1 - std::cos(angle)), 2 * std::sin(angle), angle);
    walked = moved(walked, stepBetween(before, root));
    before = root;
    expectNear({walked.ground_m, wrapAngle(walked.heading_rad - angle)}, {root.x, root.y, 0});
  }
}

TEST(Placement, MatrixAgreesWithMoved) {
  const Placement placement{{-2, 4}, 2.5f};
  const glm::vec4 point = worldFromCharacter(placement) * glm::vec4(0.3f, 1.7f, -0.4f, 1);
  const Placement stepped = moved(placement, {0.3f, -0.4f, 0});
  expectNear(glm::vec3(point), {stepped.ground_m.x, 1.7f, stepped.ground_m.y}, 1e-5f);
}

TEST(Placement, AnglesWrap) {
  EXPECT_NEAR(wrapAngle(3.5f), 3.5f - 6.2831853f, 1e-5);
  EXPECT_NEAR(wrapAngle(-13), -13 + 4 * 3.14159265f, 1e-5);
  EXPECT_NEAR(wrapAngle(1), 1, 1e-6);
}

}  // namespace
}  // namespace fourdvt::motion

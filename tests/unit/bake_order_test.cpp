// SPDX-License-Identifier: Apache-2.0
// Labels by penalty on a box between two cameras.
#include <gtest/gtest.h>

#include <cmath>

#include "bake/order.h"
#include "package/character.h"

namespace fourdvt::bake {
namespace {

// Looks from `eye` along `forward`.
PinholeCamera cameraAt(const glm::dvec3& eye, const glm::dvec3& forward) {
  const glm::dvec3 f = glm::normalize(forward), right = glm::normalize(glm::cross(f, glm::dvec3(0, 1, 0)));
  const glm::dvec3 down = glm::cross(f, right);
  const glm::dmat3 rotation = glm::transpose(glm::dmat3(right, down, f));
  PinholeCamera camera;
  camera.width = camera.height = 100;
  camera.fx = camera.fy = 100;
  camera.cx = camera.cy = 50;
  camera.cam_from_world = glm::dmat4(rotation);
  camera.cam_from_world[3] = glm::dvec4(-(rotation * eye), 1);
  return camera;
}

// Two triangles a side of the unit cube round the origin: faces 2k and 2k+1 have normal (+x, -x, +y, -y, +z, -z)[k].
struct Box {
  MeshTopology topology;
  Positions positions;
};

Box makeBox() {
  Box box;
  const glm::vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int k = 0; k < 6; ++k) {
    const glm::vec3 n = axes[k / 2] * (k % 2 ? -1.0f : 1.0f), u = axes[(k / 2 + 1) % 3], v = glm::cross(n, u);
    const uint32_t base = static_cast<uint32_t>(box.positions.size());
    for (glm::vec2 s : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)})
      box.positions.push_back(0.5f * (n + s.x * u + s.y * v));
    box.topology.face_vertices.push_back({base, base + 1, base + 2});
    box.topology.face_vertices.push_back({base, base + 2, base + 3});
  }
  box.topology.vertex_count = static_cast<uint32_t>(box.positions.size());
  return box;
}

struct Case : testing::Test {
  Box box = makeBox();
  // Camera 0 in front (+z), camera 1 at 30° from it towards +x.
  std::vector<PinholeCamera> cameras{cameraAt({0, 0, 5}, {0, 0, -1}),
                                     cameraAt({2.5, 0, 4.330127}, {-0.5, 0, -0.8660254})};
  std::vector<float> all = std::vector<float>(2 * 12, 1.0f);
  LabelOptions options{LabelMode::PaperPenalty, 2};
  std::vector<uint8_t> labels(const std::vector<float>& fractions) {
    return labelFaces(options, cameras, box.topology, box.positions, fractions);
  }
};

TEST(Penalty, IsOneMinusSquaredCosine) {
  EXPECT_NEAR(penalty({0, 0, 1}, {0, 0, -1}), 0, 1e-12);
  EXPECT_NEAR(penalty({0, 0, 1}, {0, 1, 0}), 1, 1e-12);
  EXPECT_NEAR(penalty({0, 0, 1}, {0, std::sin(0.5), -std::cos(0.5)}), std::sin(0.5) * std::sin(0.5), 1e-12);
}

TEST_F(Case, FrontFacePrefersTheCameraInFront) {
  const auto l = labels(all);
  for (int f : {8, 9}) {  // +z: 0° to camera 0, 30° to camera 1
    EXPECT_EQ(l[f], 0);
    EXPECT_EQ(l[12 + f], 1);
  }
}

TEST_F(Case, SideFaceIsSeenByTheSideCameraOnly) {
  const auto l = labels(all);
  for (int f : {0, 1}) {  // +x: edge-on and behind for camera 0
    EXPECT_EQ(l[f], 1);
    EXPECT_EQ(l[12 + f], package::kNoCamera);
  }
}

TEST_F(Case, FacesTurnedAwayGetNoCameraThoughThePenaltyIsBlindToTheSign) {
  const auto l = labels(all);
  for (int f : {10, 11}) {  // -z: penalty 0, but behind
    EXPECT_EQ(l[f], package::kNoCamera);
    EXPECT_EQ(l[12 + f], package::kNoCamera);
  }
}

TEST_F(Case, PartlyHiddenCamerasServeOnlyWhereNoneQualifies) {
  std::vector<float> shares = all;
  shares[8] = 0.5f;  // camera 0, face 8: half hidden
  EXPECT_EQ(labels(shares)[8], 1);
  EXPECT_EQ(labels(shares)[12 + 8], package::kNoCamera);
  shares[12 + 8] = 0.5f;  // now camera 1 too
  EXPECT_EQ(labels(shares)[8], 0);
  EXPECT_EQ(labels(shares)[12 + 8], 1);
  shares[8] = shares[12 + 8] = 0.2f;
  EXPECT_EQ(labels(shares)[8], package::kNoCamera);
}

}  // namespace
}  // namespace fourdvt::bake

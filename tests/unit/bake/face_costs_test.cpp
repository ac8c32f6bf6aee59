// SPDX-License-Identifier: Apache-2.0
// Penalties and feasible cameras on a box between two cameras; visibility hysteresis on hand-made fractions.
#include "bake/labels/face_costs.h"

#include <gtest/gtest.h>

#include <cmath>

#include "label_fixture.h"
#include "lens_shift.h"

namespace fourdvt::bake {
namespace {

struct BoxCosts : ::testing::Test {
  Box box = makeBox();
  std::vector<PinholeCamera> cameras = boxCameras();
  std::vector<float> all = std::vector<float>(2 * 12, 1.0f);
  FaceCosts measure(const std::vector<float>& fractions, Penalty penalty = Penalty::Axis) {
    FaceCostOptions options;
    options.penalty = penalty;
    return measureFaceCosts(options, cameras, box.topology, box.positions, fractions);
  }
};

TEST(PenaltyOfEquation1, IsOneMinusSquaredCosine) {
  EXPECT_NEAR(penalty({0, 0, 1}, {0, 0, -1}), 0, 1e-12);
  EXPECT_NEAR(penalty({0, 0, 1}, {0, 1, 0}), 1, 1e-12);
  EXPECT_NEAR(penalty({0, 0, 1}, {0, std::sin(0.5), -std::cos(0.5)}), std::sin(0.5) * std::sin(0.5), 1e-12);
}

TEST_F(BoxCosts, FrontFaceIsFeasibleForBothWithTheirAngles) {
  const FaceCosts costs = measure(all);
  for (int f : {8, 9}) {  // +z: 0° to camera 0, 30° to camera 1
    EXPECT_EQ(costs.feasible[f], 0b11u);
    EXPECT_NEAR(costs.penalty[f * 2 + 0], 0, 1e-6);
    EXPECT_NEAR(costs.penalty[f * 2 + 1], 0.25, 1e-6);  // sin² 30°
  }
}

// Cameras whose optical axis misses the picture.
TEST_F(BoxCosts, AShiftedLensHasThePenaltiesOfWhereItLooks) {
  for (PinholeCamera& camera : cameras) camera = fourdvt::testing::withShiftedLens(camera, 0.6);
  const FaceCosts costs = measure(all);
  for (int f : {8, 9}) {
    EXPECT_NEAR(costs.penalty[f * 2 + 0], 0, 1e-6);
    EXPECT_NEAR(costs.penalty[f * 2 + 1], 0.25, 1e-6);
  }
}

TEST_F(BoxCosts, SideFaceIsFeasibleForTheSideCameraOnly) {
  const FaceCosts costs = measure(all);
  for (int f : {0, 1}) {  // +x: edge-on and behind for camera 0
    EXPECT_EQ(costs.feasible[f], 0b10u);
    EXPECT_EQ(costs.penalty[f * 2 + 0], 1);
    EXPECT_NEAR(costs.penalty[f * 2 + 1], 0.75, 1e-6);
  }
}

TEST_F(BoxCosts, FacesTurnedAwayAreInfeasibleThoughThePenaltyIsBlindToTheSign) {
  const FaceCosts costs = measure(all);
  for (int f : {10, 11}) EXPECT_EQ(costs.feasible[f], 0u);  // -z: penalty 0, but behind
}

TEST_F(BoxCosts, PartlyHiddenCamerasServeOnlyWhereNoneQualifies) {
  std::vector<float> fractions = all;
  fractions[8] = 0.5f;  // camera 0, face 8: half hidden
  EXPECT_EQ(measure(fractions).feasible[8], 0b10u);
  fractions[12 + 8] = 0.5f;  // now camera 1 too
  EXPECT_EQ(measure(fractions).feasible[8], 0b11u);
  fractions[8] = fractions[12 + 8] = 0.2f;
  EXPECT_EQ(measure(fractions).feasible[8], 0u);
  EXPECT_EQ(measure(fractions).unseen[8], 1);
  EXPECT_EQ(measure(fractions).penalty[8 * 2], kUnseenPenalty);
  EXPECT_EQ(measure(all).unseen[8], 0);
}

TEST_F(BoxCosts, PartialCamerasPayForTheSquareOfTheHiddenShare) {
  std::vector<float> fractions = all;
  fractions[8] = 0.5f;  // camera 0, face 8: penalty 0 if it were fully visible
  fractions[12 + 9] = 0.2f;
  const FaceCosts costs = measure(fractions);
  EXPECT_EQ(costs.partial[8], 0b01u);
  EXPECT_NEAR(costs.penalty[8 * 2], 0.25, 1e-6);
  EXPECT_EQ(costs.partial[9], 0u);  // below the fallback
  EXPECT_EQ(costs.penalty[9 * 2 + 1], 1);
  EXPECT_EQ(costs.partial[0], 0u);  // behind
}

TEST_F(BoxCosts, RayPenaltyLooksAtTheFaceNotAlongTheAxis) {
  const FaceCosts costs = measure(all, Penalty::Ray);
  for (int f : {8, 9}) {
    const glm::uvec3 v = box.topology.face_vertices[f];
    const glm::dvec3 centre =
        (glm::dvec3(box.positions[v.x]) + glm::dvec3(box.positions[v.y]) + glm::dvec3(box.positions[v.z])) / 3.0;
    const glm::dvec3 ray = glm::normalize(centre - glm::dvec3(0, 0, 5));
    EXPECT_NEAR(costs.penalty[f * 2], 1 - ray.z * ray.z, 1e-6);
    EXPECT_GT(costs.penalty[f * 2], 1e-3);  // the axis penalty is 0
  }
}

// Compares with the area of the face's projected corners, which requires small faces: the box is scaled down.
TEST_F(BoxCosts, ResolutionPenaltyIsTheShareOfTheBestCamerasPixels) {
  for (glm::vec3& p : box.positions) p *= 0.01f;
  cameras[1].fx = cameras[1].fy = 150;
  const FaceCosts costs = measure(all, Penalty::Resolution);
  const auto pixels = [&](const PinholeCamera& camera, int face) {
    glm::dvec2 p[3];
    for (int k = 0; k < 3; ++k) p[k] = camera.project(glm::dvec3(box.positions[box.topology.face_vertices[face][k]]));
    return 0.5 * std::abs((p[1] - p[0]).x * (p[2] - p[0]).y - (p[1] - p[0]).y * (p[2] - p[0]).x);
  };
  // Camera 1 is as far as camera 0 and has the longer focal length: if it faced camera 1, the face would have most
  // pixels.
  const double area = 0.5 * 0.01 * 0.01, distance = 5, best = area * 150 * 150 / (distance * distance);
  for (int f : {8, 9})
    for (int c : {0, 1}) EXPECT_NEAR(costs.penalty[f * 2 + c], 1 - pixels(cameras[c], f) / best, 0.01) << c;
  EXPECT_LT(costs.penalty[8 * 2 + 1], costs.penalty[8 * 2]);  // axis and ray rank them in reverse
}

TEST_F(BoxCosts, FacesWithoutAreaHaveNoCamera) {
  const glm::uvec3 v = box.topology.face_vertices[8];
  box.positions[v.y] = box.positions[v.x];
  EXPECT_EQ(measure(all).feasible[8], 0u);
}

std::vector<std::vector<float>> history(std::initializer_list<float> values) {
  std::vector<std::vector<float>> frames;
  for (float v : values) frames.push_back({v});
  return frames;
}

bool visibleAfter(std::initializer_list<float> values, size_t middle) {
  const FaceCostOptions options;
  return steadyFractions(history(values), middle, options)[0] >= options.visible_fraction;
}

TEST(SteadyFractions, RemoveAOneFrameFlicker) {
  EXPECT_TRUE(visibleAfter({1, 1, 0.9f, 1, 1}, 2));
  EXPECT_FALSE(visibleAfter({0, 0, 1, 0, 0}, 2));
  EXPECT_TRUE(visibleAfter({1, 1, 1, 0, 0}, 2));
  EXPECT_FALSE(visibleAfter({0, 0, 0.9f, 1, 1}, 2));
}

TEST(SteadyFractions, NeverAddACameraThatDoesNotSeeTheFace) {
  EXPECT_FALSE(visibleAfter({1, 1, 0.1f, 1, 1}, 2));
  EXPECT_EQ(steadyFractions(history({1, 1, 0.1f, 1, 1}), 2, {})[0], 0.1f);
}

TEST(SteadyFractions, RemovedCamerasStillServeAsFallback) {
  const FaceCostOptions options;
  const float after = steadyFractions(history({0, 0, 1, 0, 0}), 2, options)[0];
  EXPECT_LT(after, options.visible_fraction);
  EXPECT_GE(after, options.fallback_fraction);
}

TEST(SteadyFractions, AnEvenVoteChangesNothing) {
  EXPECT_TRUE(visibleAfter({1, 1, 0, 0}, 1));
  EXPECT_FALSE(visibleAfter({1, 1, 0.9f, 0.9f}, 2));
}

}  // namespace
}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
#include "live/server/live_hull.h"

#include <gtest/gtest.h>

#include "live_fixture.h"
#include "reconstruct/mesh_checks.h"

namespace fourdvt::live {
namespace {

using reconstruct::Shape;

constexpr int kWidth = 320, kHeight = 240;
const BoundingBox kHullBounds{glm::vec3(-0.9f), glm::vec3(0.9f)};

struct Outlines {
  std::vector<PinholeCamera> cameras;
  std::vector<std::vector<Ring16>> rings;
  std::vector<const std::vector<Ring16>*> pointers() const {
    std::vector<const std::vector<Ring16>*> out;
    for (const auto& r : rings) out.push_back(&r);
    return out;
  }
};

Outlines outlines(const Shape& shape, double tolerance_px) {
  Outlines out{reconstruct::sixCameras(), {}};
  for (const PinholeCamera& camera : out.cameras)
    out.rings.push_back(ringsOf(silhouette::outlineOf(reconstruct::coverageOf(camera, shape), {tolerance_px})));
  return out;
}

HullMaker makerOf(const std::vector<PinholeCamera>& cameras) {
  auto maker = HullMaker::create(cameras, {kHullBounds});
  EXPECT_TRUE(maker.ok());
  return maker.take();
}

// Ring along the border of the whole picture.
Ring16 wholePicture() {
  const auto w = uint16_t(16 * kWidth), h = uint16_t(16 * kHeight);
  return {{0, 0}, {0, h}, {w, h}, {w, 0}};  // the background inside
}

TEST(LiveHull, HasTheVolumeOfTheTrueHull) {
  const Shape ball = reconstruct::ballShape(glm::dvec3(0.1, 0, 0), 0.5);
  const Shape box = reconstruct::boxShape(glm::dvec3(-0.3, -0.4, -0.2), glm::dvec3(0.2, 0.4, 0.3));
  for (const Shape& shape : {ball, box}) {
    const Outlines seen = outlines(shape, 0.5);
    const auto hull = makerOf(seen.cameras).make(seen.pointers());
    ASSERT_TRUE(hull.ok()) << hull.error().message;
    const auto report = reconstruct::checkMesh(hull.value().mesh);
    EXPECT_TRUE(report.solid()) << describe(report);
    const double truth_m3 = reconstruct::hullVolume(reconstruct::Rig(seen.cameras, shape), shape, 0.9);
    EXPECT_NEAR(report.volume_m3, truth_m3, 0.02 * truth_m3);
    EXPECT_EQ(hull.value().attempts, 1);
    EXPECT_TRUE(hull.value().left_out.empty());
  }
}

TEST(LiveHull, CoarseOutlinesGiveFewTriangles) {
  const Shape ball = reconstruct::ballShape(glm::dvec3(0), 0.5);
  size_t last = SIZE_MAX;
  for (const double tolerance_px : {0.5, 2.0, 8.0}) {
    const Outlines seen = outlines(ball, tolerance_px);
    const auto hull = makerOf(seen.cameras).make(seen.pointers());
    ASSERT_TRUE(hull.ok());
    EXPECT_LT(hull.value().mesh.faces.size(), last);
    last = hull.value().mesh.faces.size();
  }
}

TEST(LiveHull, CamerasWithoutPictureOrRingsCarveNothing) {
  const Shape ball = reconstruct::ballShape(glm::dvec3(0), 0.5);
  Outlines seen = outlines(ball, 1);
  const HullMaker maker = makerOf(seen.cameras);
  const double all_m3 = reconstruct::checkMesh(maker.make(seen.pointers()).value().mesh).volume_m3;
  auto pointers = seen.pointers();
  pointers[0] = nullptr;
  const double five_m3 = reconstruct::checkMesh(maker.make(pointers).value().mesh).volume_m3;
  EXPECT_GT(five_m3, 1.01 * all_m3);
  seen.rings[0].clear();
  EXPECT_EQ(reconstruct::checkMesh(maker.make(seen.pointers()).value().mesh).volume_m3, five_m3);
  for (size_t c = 1; c < 5; ++c) seen.rings[c].clear();
  const auto one = maker.make(seen.pointers());
  ASSERT_FALSE(one.ok());
  EXPECT_EQ(one.error().id, ErrorId::NothingVisible);
}

TEST(LiveHull, NobodyIsAnEmptyHull) {
  Outlines seen = outlines(reconstruct::ballShape(glm::dvec3(0), 0.5), 1);
  for (auto& rings : seen.rings) rings = {wholePicture()};
  const auto hull = makerOf(seen.cameras).make(seen.pointers());
  ASSERT_TRUE(hull.ok()) << hull.error().message;
  EXPECT_TRUE(hull.value().mesh.faces.empty());
}

// Ring that crosses itself by far more than any tolerance: no hull closes with it.
TEST(LiveHull, GoesOnWithoutAnOutlineThatCrossesItself) {
  const Shape ball = reconstruct::ballShape(glm::dvec3(0), 0.5);
  Outlines seen = outlines(ball, 1);
  const HullMaker maker = makerOf(seen.cameras);
  auto without = seen.pointers();
  without[2] = nullptr;
  const double truth_m3 = reconstruct::checkMesh(maker.make(without).value().mesh).volume_m3;
  auto at = [](int x, int y) { return Point16{uint16_t(16 * x), uint16_t(16 * y)}; };
  seen.rings[2] = {{at(100, 60), at(220, 180), at(220, 60), at(100, 180)}, {at(90, 90), at(230, 100), at(160, 190)}};
  const auto hull = maker.make(seen.pointers());
  ASSERT_TRUE(hull.ok()) << hull.error().message;
  ASSERT_EQ(hull.value().left_out, std::vector<size_t>{2});
  EXPECT_GT(hull.value().attempts, 1);
  EXPECT_NEAR(reconstruct::checkMesh(hull.value().mesh).volume_m3, truth_m3, 0.03 * truth_m3);
}

TEST(LiveHull, LeavesOutSpecksAndWhatNobodySees) {
  const Shape ball = reconstruct::ballShape(glm::dvec3(0), 0.4);
  const Shape both = reconstruct::either(ball, reconstruct::ballShape(glm::dvec3(0.6, 0.3, 0), 0.012));
  const Outlines seen = outlines(both, 0.5);
  const auto hull = makerOf(seen.cameras).make(seen.pointers());
  ASSERT_TRUE(hull.ok());
  EXPECT_EQ(reconstruct::checkMesh(hull.value().mesh).components, 1);
  // Bounds far larger than the pictures: no camera carves their corners.
  auto large = HullMaker::create(seen.cameras, {{glm::vec3(-1.9f), glm::vec3(1.9f)}});
  ASSERT_TRUE(large.ok());
  const auto in_large = large.value().make(seen.pointers());
  ASSERT_TRUE(in_large.ok());
  const auto report = reconstruct::checkMesh(in_large.value().mesh);
  EXPECT_EQ(report.components, 1);
  EXPECT_NEAR(report.volume_m3, reconstruct::checkMesh(hull.value().mesh).volume_m3, 0.01);
}

TEST(LiveHull, RefusesACameraWithinTheBounds) {
  auto maker = HullMaker::create(reconstruct::sixCameras(), {{glm::vec3(-4), glm::vec3(4)}});
  ASSERT_FALSE(maker.ok());
  EXPECT_EQ(maker.error().id, ErrorId::InvalidArgument);
  EXPECT_NE(maker.error().message.find("bounds"), std::string::npos);
}

TEST(RingCoverage, IsTheExactArea) {
  RingCoverage coverage;
  // A triangle within a rectangle, both with fractional pixel coordinates.
  auto at = [](double x, double y) { return Point16{uint16_t(16 * x), uint16_t(16 * y)}; };
  const std::vector<Ring16> rings = {{at(1.5, 2.25), at(1.5, 20.75), at(30.25, 20.75), at(30.25, 2.25)},
                                     {at(5, 5.5), at(22.75, 8), at(10.5, 16.25)}};
  const auto& drawn = coverage.draw(rings, {0, 0, 40, 30}, 40, 30, 48, 32);
  double sum = 0;
  for (const float v : drawn) sum += v;
  const double triangle = 0.5 * std::abs((22.75 - 5) * (16.25 - 5.5) - (10.5 - 5) * (8 - 5.5));
  EXPECT_NEAR(sum, (30.25 - 1.5) * (20.75 - 2.25) - triangle, 1e-3);
  EXPECT_FLOAT_EQ(drawn[3 * 48 + 1], 0.5f);
  EXPECT_FLOAT_EQ(drawn[2 * 48 + 1], 0.375f);
  EXPECT_FLOAT_EQ(drawn[10 * 48 + 10], 0);
  // Stretched to half: a quarter of the area.
  double half = 0;
  for (const float v : coverage.draw(rings, {0, 0, 40, 30}, 20, 15, 20, 15)) half += v;
  EXPECT_NEAR(half, sum / 4, 1e-3);
}

TEST(RingCoverage, AgreesWithTheCoverageThatTheRingsAreFrom) {
  const PinholeCamera camera = reconstruct::sixCameras()[0];
  const Image truth = reconstruct::coverageOf(camera, reconstruct::ballShape(glm::dvec3(0), 0.5));
  const auto rings = ringsOf(silhouette::outlineOf(truth, {0.1}));
  RingCoverage coverage;
  const auto& drawn = coverage.draw(rings, {0, 0, kWidth, kHeight}, kWidth, kHeight, kWidth, kHeight);
  for (size_t i = 0; i < truth.pixels.size(); ++i) ASSERT_NEAR(1 - drawn[i], truth.pixels[i] / 255.0, 0.35) << i;
}

}  // namespace
}  // namespace fourdvt::live

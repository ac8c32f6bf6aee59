// SPDX-License-Identifier: Apache-2.0
// One frame from pictures to surface: pixels outside the lens's picture carve nothing, and empty cameras are left out.
#include "reconstruct/run/frame_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "capture/undistort.h"
#include "reconstruct/run/report.h"
#include "silhouette_fixture.h"

namespace fourdvt::reconstruct {
namespace {

const ReconstructOptions kHull{.voxel_m = 0.02, .stereo = false};
constexpr double kBall_m = 0.15;

// Six cameras round the origin; the first one has a long lens.
std::vector<capture::CaptureCamera> camerasOfStage() {
  std::vector<capture::CaptureCamera> out;
  for (const PinholeCamera& camera : ringCameras(6)) out.push_back({camera, {}});
  out[0].pinhole.fx = out[0].pinhole.fy = 600;
  return out;
}

std::vector<Image> picturesOf(const std::vector<capture::CaptureCamera>& cameras, const glm::dvec3& ball) {
  std::vector<Image> out;
  for (const capture::CaptureCamera& camera : cameras) {
    const Image coverage = coverageOf(camera.pinhole, ballShape(ball, kBall_m));
    Image& rgba = out.emplace_back(coverage.width, coverage.height, 4, 128);
    for (size_t i = 0; i < coverage.pixels.size(); ++i) rgba.pixels[4 * i + 3] = coverage.pixels[i];
  }
  return out;
}

FrameSurface surfaceOf(const std::vector<capture::CaptureCamera>& cameras, const std::vector<Image>& pictures) {
  auto maker = SurfaceMaker::create(kHull, cameras, nullptr);
  EXPECT_TRUE(maker.ok()) << maker.error().message;
  auto surface = maker.value().make(pictures);
  EXPECT_TRUE(surface.ok()) << surface.error().message;
  return surface.take();
}

TEST(FrameSurface, SmallPicturesAreNotReduced) {
  EXPECT_EQ(stereoReduction(0.0025), 2);  // for a person who fills 1280 rows
  EXPECT_EQ(stereoReduction(0.0049), 2);
  EXPECT_EQ(stereoReduction(0.0051), 1);
  EXPECT_EQ(stereoReduction(0.015), 1);
}

TEST(FrameSurface, WhatTheLensDidNotShowCarvesNothing) {
  auto cameras = camerasOfStage();
  const PinholeCamera& first = cameras[0].pinhole;
  // A ball at the left border of the first picture.
  const glm::dvec3 ball = first.centreInWorld() + rayInWorld(first, {20, 120}) * 2.1;
  std::vector<Image> pictures = picturesOf(cameras, ball);
  cameras[0].distortion.k1 = 5;  // undistorted, the picture's outermost 17 columns lie outside of what was captured
  const Image captured = capture::Undistorter(cameras[0]).apply(Image(first.width, first.height, 1, 255));
  ASSERT_EQ(*captured.at(5, 120), 0);
  ASSERT_EQ(*captured.at(40, 120), 255);
  size_t cut = 0;
  for (size_t i = 0; i < captured.pixels.size(); ++i) {
    uint8_t& matte = pictures[0].pixels[4 * i + 3];
    cut += matte > 127 && captured.pixels[i] == 0;
    if (captured.pixels[i] == 0) matte = 0;
  }
  ASSERT_GT(cut, 200u);
  const glm::dvec3 unseen = first.centreInWorld() + rayInWorld(first, {6, 120}) * 2.1;
  ASSERT_LT(glm::distance(unseen, ball), 0.6 * kBall_m);
  EXPECT_TRUE(meshHolds(surfaceOf(cameras, pictures).mesh, unseen));
  // Without the distortion the same picture cuts the ball.
  cameras[0].distortion = {};
  const FrameSurface carved = surfaceOf(cameras, pictures);
  EXPECT_FALSE(meshHolds(carved.mesh, unseen));
  EXPECT_TRUE(meshHolds(carved.mesh, first.centreInWorld() + rayInWorld(first, {35, 120}) * 2.1));
}

// A ball is a small part of the visible space; mattes that cover their pictures leave all of it.
TEST(FrameSurface, VolumeIsThatOfTheBallOrOfAllThatIsSeen) {
  const auto cameras = camerasOfStage();
  std::vector<Image> pictures = picturesOf(cameras, {0, 0, 0});
  const FrameFigures ball = surfaceOf(cameras, pictures).figures;
  const double truth_m3 = 4.0 / 3 * 3.14159265 * std::pow(kBall_m, 3);
  EXPECT_GT(ball.volume_m3, truth_m3);
  EXPECT_LT(ball.volume_m3, 1.2 * truth_m3);
  EXPECT_LT(ball.volume_m3, 0.1 * ball.seen_m3);
  ASSERT_EQ(ball.cover.size(), cameras.size());
  EXPECT_LT(ball.cover[1], 0.3);
  EXPECT_GT(ball.cover[1], 0.01);
  for (Image& picture : pictures)
    for (size_t i = 3; i < picture.pixels.size(); i += 4) picture.pixels[i] = 255;
  const FrameFigures all = surfaceOf(cameras, pictures).figures;
  EXPECT_EQ(all.cover[1], 1);
  EXPECT_EQ(all.seen_m3, ball.seen_m3);
  EXPECT_NEAR(all.volume_m3 / all.seen_m3, 1, 0.1);
}

TEST(ReconstructReport, WarnsOfMattesThatShowNoOutline) {
  capture::Capture capture;
  capture.cameras = camerasOfStage();
  FrameFigures figures;
  figures.overlap.assign(6, 0.99), figures.cover.assign(6, 0.2);
  figures.volume_m3 = 0.1, figures.seen_m3 = 10;
  const ReconstructSummary usual = summarise(capture, {{"walk", {figures}}});
  EXPECT_EQ(usual.warnings, std::vector<std::string>{});
  EXPECT_DOUBLE_EQ(usual.mean_cover, 0.2);
  EXPECT_EQ(usual.volume_m3, 0.1);
  EXPECT_EQ(usual.seen_m3, 10);
  figures.cover[2] = 0.97, figures.volume_m3 = 9;
  const std::vector<std::string> warnings = summarise(capture, {{"walk", {figures}}}).warnings;
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("walk, camera \"cam02\" (97 %): the mattes cover"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("walk: the surface fills 90 % of the 10 m³"), std::string::npos) << warnings[1];
  figures.cover.clear(), figures.volume_m3 = figures.seen_m3 = 0;  // of an earlier version
  EXPECT_EQ(summarise(capture, {{"walk", {figures}}}).warnings, std::vector<std::string>{});
}

TEST(FrameSurface, ACameraThatSeesNobodyIsLeftOut) {
  const auto cameras = camerasOfStage();
  std::vector<Image> pictures = picturesOf(cameras, {0, 0, 0});
  const auto empty = [&](size_t camera) {
    for (size_t i = 3; i < pictures[camera].pixels.size(); i += 4) pictures[camera].pixels[i] = 0;
  };
  empty(2);
  const FrameSurface surface = surfaceOf(cameras, pictures);
  EXPECT_TRUE(meshHolds(surface.mesh, {0, 0, 0}));
  EXPECT_EQ(surface.silhouettes.size(), cameras.size());
  EXPECT_EQ(surface.figures.triangles, surface.mesh.faces.size());
  ASSERT_EQ(surface.figures.overlap.size(), cameras.size());
  for (size_t c = 0; c < cameras.size(); ++c) {
    if (c == 2)
      EXPECT_TRUE(std::isnan(surface.figures.overlap[c]));
    else
      EXPECT_GT(surface.figures.overlap[c], 0.93) << c;
  }
  for (size_t c : {0, 1, 3, 4}) empty(c);
  auto maker = SurfaceMaker::create(kHull, cameras, nullptr);
  ASSERT_TRUE(maker.ok());
  EXPECT_EQ(maker.value().make(pictures).error().id, ErrorId::NothingVisible);
}

TEST(FrameSurface, PolyhedralAndFairedSurfacesComeWithTheirFigures) {
  const auto cameras = camerasOfStage();
  ReconstructOptions options = kHull;
  options.hull = HullKind::Polyhedral;
  options.fairing = 3;
  auto maker = SurfaceMaker::create(options, cameras, nullptr);
  ASSERT_TRUE(maker.ok());
  const auto surface = maker.value().make(picturesOf(cameras, {0, 0, 0}));
  ASSERT_TRUE(surface.ok()) << surface.error().message;
  EXPECT_EQ(surface.value().figures.fallback, "");
  EXPECT_TRUE(meshHolds(surface.value().mesh, {0, 0, 0.9 * kBall_m}));
  for (double overlap : surface.value().figures.overlap) EXPECT_GT(overlap, 0.95);
}

}  // namespace
}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
// Rigs of any size, with many cameras, shifted lenses, pictures of any shape: the reconstruction is the performer.
#include <gtest/gtest.h>

#include "reconstruct/mesh_checks.h"
#include "reconstruct/run/frame_surface.h"
#include "silhouette_fixture.h"

namespace fourdvt::reconstruct {
namespace {

using Cameras = std::vector<PinholeCamera>;

// A body with an arm, and a ball beside it.
Shape figure() {
  return either(
      either(boxShape({-0.1, -0.35, -0.07}, {0.1, 0.25, 0.07}), boxShape({0.05, 0.1, -0.03}, {0.35, 0.17, 0.04})),
      ballShape({0, 0.35, 0}, 0.1));
}

std::vector<Image> picturesOf(const Cameras& cameras, const Shape& shape) {
  std::vector<Image> out;
  for (const PinholeCamera& camera : cameras) {
    const Image coverage = coverageOf(camera, shape);
    Image& rgba = out.emplace_back(coverage.width, coverage.height, 4, 128);
    for (size_t i = 0; i < coverage.pixels.size(); ++i) rgba.pixels[4 * i + 3] = coverage.pixels[i];
  }
  return out;
}

std::vector<capture::CaptureCamera> captured(const Cameras& cameras, double scale = 1) {
  std::vector<capture::CaptureCamera> out;
  for (const PinholeCamera& camera : cameras) {
    out.push_back({camera, {}});
    out.back().pinhole.cam_from_world[3] *= glm::dvec4(scale, scale, scale, 1);
  }
  return out;
}

FrameSurface surfaceOf(const std::vector<capture::CaptureCamera>& cameras, const std::vector<Image>& pictures,
                       ReconstructOptions options = {}) {
  options.stereo = false;
  auto maker = SurfaceMaker::create(options, cameras, nullptr);
  EXPECT_TRUE(maker.ok());
  auto surface = maker.value().make(pictures);
  EXPECT_TRUE(surface.ok()) << surface.error().message;
  return surface.ok() ? surface.take() : FrameSurface{};
}

double lowestOverlap(const FrameSurface& surface) {
  return *std::min_element(surface.figures.overlap.begin(), surface.figures.overlap.end());
}

// Cameras round the origin, at several heights.
Cameras manyCameras(int count) {
  Cameras out;
  for (int k = 0; k < count; ++k) {
    const double azimuth = 2.39996 * k, height = -0.5 + 1.8 * (k + 0.5) / count;
    out.push_back(lookingAt({0, 0, 0}, {2 * std::sin(azimuth), height, 2 * std::cos(azimuth)}, 200, 200, 300));
    out.back().name = "cam" + std::to_string(k);
  }
  return out;
}

// Crops a camera's picture round the pixel that shows the point.
PinholeCamera croppedRound(PinholeCamera camera, const glm::dvec3& point, int width, int height) {
  const glm::dvec3 p = camera.project(point);
  camera.cx += width / 2.0 - std::round(p.x), camera.cy += height / 2.0 - std::round(p.y);
  camera.width = width, camera.height = height;
  return camera;
}

TEST(AnyRig, AScaledSceneGivesTheScaledSurface) {
  const Cameras cameras = manyCameras(9);
  const std::vector<Image> pictures = picturesOf(cameras, figure());
  const FrameSurface one = surfaceOf(captured(cameras), pictures);
  ASSERT_GT(one.mesh.faces.size(), 1000u);
  EXPECT_GT(lowestOverlap(one), 0.96);
  for (const double scale : {0.05, 20.0}) {
    const FrameSurface other = surfaceOf(captured(cameras, scale), pictures);
    EXPECT_NEAR(lowestOverlap(other), lowestOverlap(one), 0.002) << scale;
    EXPECT_NEAR(double(other.mesh.faces.size()), double(one.mesh.faces.size()), 0.05 * double(one.mesh.faces.size()))
        << scale;
    ASSERT_EQ(other.mesh.positions.size(), one.mesh.positions.size()) << scale;
    float farthest = 0;
    for (size_t v = 0; v < one.mesh.positions.size(); ++v)
      farthest = std::max(farthest, glm::distance(other.mesh.positions[v] / float(scale), one.mesh.positions[v]));
    EXPECT_LT(farthest, 0.05 * one.figures.voxel_m) << scale;
    EXPECT_NEAR(other.figures.voxel_m / scale, one.figures.voxel_m, 1e-3 * one.figures.voxel_m);
  }
}

TEST(AnyRig, PolyhedraAndFairingFollowTheScene) {
  const Cameras cameras = manyCameras(6);
  const std::vector<Image> pictures = picturesOf(cameras, figure());
  ReconstructOptions options;
  options.hull = HullKind::Polyhedral;
  options.fairing = 2;
  const FrameSurface one = surfaceOf(captured(cameras), pictures, options);
  EXPECT_EQ(one.figures.fallback, "");
  for (const double scale : {0.05, 20.0}) {
    const FrameSurface other = surfaceOf(captured(cameras, scale), pictures, options);
    EXPECT_EQ(other.figures.fallback, "") << scale;
    EXPECT_NEAR(lowestOverlap(other), lowestOverlap(one), 0.002) << scale;
    EXPECT_NEAR(double(other.mesh.faces.size()), double(one.mesh.faces.size()), 0.05 * double(one.mesh.faces.size()));
  }
}

TEST(AnyRig, AScaleIsKeptWithinASequence) {
  const Cameras cameras = manyCameras(6);
  auto maker = SurfaceMaker::create({.stereo = false}, captured(cameras), nullptr);
  ASSERT_TRUE(maker.ok());
  const auto first = maker.value().make(picturesOf(cameras, figure()));
  const std::vector<Image> nearer = picturesOf(cameras, ballShape({0, 0, 0}, 0.2));
  const auto second = maker.value().make(nearer);
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_EQ(second.value().figures.voxel_m, first.value().figures.voxel_m);
  EXPECT_EQ(second.value().figures.person_metre_m, first.value().figures.person_metre_m);
  // A resumed run uses the scale of the stored figures; another sequence measures its own.
  auto resumed = SurfaceMaker::create({.stereo = false}, captured(cameras), nullptr);
  ASSERT_TRUE(resumed.value().begin(&first.value().figures).ok());
  const auto again = resumed.value().make(nearer);
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again.value().mesh.positions, second.value().mesh.positions);
  ASSERT_TRUE(resumed.value().begin().ok());
  const auto other = resumed.value().make(nearer);
  ASSERT_TRUE(other.ok());
  EXPECT_GT(other.value().figures.person_metre_m, 1.3 * first.value().figures.person_metre_m);
}

TEST(AnyRig, FacesHaveABudget) {
  const Cameras cameras = manyCameras(6);
  const std::vector<Image> pictures = picturesOf(cameras, figure());
  const FrameSurface all = surfaceOf(captured(cameras), pictures, {.adaptivity = 0});
  ReconstructOptions options{.adaptivity = 0};
  options.voxel_m = all.figures.voxel_m;
  options.faces = 2000;
  const FrameSurface few = surfaceOf(captured(cameras), pictures, options);
  EXPECT_EQ(few.figures.triangles_made, all.figures.triangles);
  EXPECT_GT(few.figures.triangles_made, 4000u);
  EXPECT_LE(few.mesh.faces.size(), 2000u);
  EXPECT_GT(few.mesh.faces.size(), 1800u);
  EXPECT_TRUE(checkMesh(few.mesh).closed());
  EXPECT_NEAR(lowestOverlap(few), lowestOverlap(all), 0.01);
  // Without a voxel size, the budget of faces enlarges the voxels, so that few faces are simplified away.
  options.voxel_m = 0;
  EXPECT_LT(surfaceOf(captured(cameras), pictures, options).figures.triangles_made, 5 * 2000u);
}

TEST(AnyRig, OfSixtyFourAndOfAHundredAndTwentyEightCameras) {
  Cameras cameras = manyCameras(128);
  for (PinholeCamera& camera : cameras) camera = croppedRound(camera, {0, 0, 0}, 160, 160);
  const std::vector<Image> pictures = picturesOf(cameras, figure());
  for (const size_t apart : {2, 1}) {
    Cameras some;
    std::vector<Image> theirs;
    for (size_t k = 0; k < cameras.size(); k += apart) some.push_back(cameras[k]), theirs.push_back(pictures[k]);
    const FrameSurface surface = surfaceOf(captured(some), theirs);
    ASSERT_EQ(surface.figures.overlap.size(), 128 / apart);
    EXPECT_GT(lowestOverlap(surface), 0.94) << some.size();
    EXPECT_TRUE(meshHolds(surface.mesh, {0.3, 0.13, 0}));
    EXPECT_FALSE(meshHolds(surface.mesh, {0.25, 0, 0}));  // below the arm
  }
}

TEST(AnyRig, PrincipalPointsOutsideThePicture) {
  Cameras cameras;
  for (int k = 0; k < 8; ++k) {
    const double azimuth = 0.785 * k + 0.2;
    const glm::dvec3 from(2 * std::sin(azimuth), 0.4, 2 * std::cos(azimuth));
    // Looks past the performer on alternating sides.
    const glm::dvec3 aside = (k % 2 ? 1.6 : -1.4) * glm::dvec3(std::cos(azimuth), 0.2, -std::sin(azimuth));
    cameras.push_back(croppedRound(lookingAt(aside, from, 800, 800, 300), {0, 0, 0}, 200, 200));
    ASSERT_TRUE(cameras[k].cx < 0 || cameras[k].cx > 200) << cameras[k].cx;
  }
  const FrameSurface surface = surfaceOf(captured(cameras), picturesOf(cameras, figure()));
  EXPECT_GT(lowestOverlap(surface), 0.95);
  EXPECT_TRUE(meshHolds(surface.mesh, {0, 0, 0}));
  EXPECT_FALSE(meshHolds(surface.mesh, {0.25, 0, 0}));
}

TEST(AnyRig, PortraitAndLandscapeOfSeveralResolutions) {
  Cameras cameras = manyCameras(8);
  for (size_t k = 0; k < cameras.size(); ++k) {
    const glm::dvec3 from = cameras[k].centreInWorld();
    const int wide = 160 + 40 * int(k % 3), narrow = wide * 3 / 4;
    cameras[k] =
        k % 2 ? lookingAt({0, 0, 0}, from, wide, narrow, wide * 0.9) : lookingAt({0, 0, 0}, from, narrow, wide, wide);
  }
  glm::dmat4 roll(1.0);  // a landscape camera mounted on its side
  roll[0] = {0, 1, 0, 0}, roll[1] = {-1, 0, 0, 0};
  cameras[3].cam_from_world = roll * cameras[3].cam_from_world;
  const FrameSurface surface = surfaceOf(captured(cameras), picturesOf(cameras, figure()));
  EXPECT_GT(lowestOverlap(surface), 0.93);
  EXPECT_TRUE(meshHolds(surface.mesh, {0.3, 0.13, 0}));
  EXPECT_FALSE(meshHolds(surface.mesh, {0.25, 0, 0}));
}

}  // namespace
}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "reconstruct/carve.h"
#include "reconstruct/mesh_checks.h"
#include "silhouette_fixture.h"

namespace fourdvt::reconstruct {
namespace {

std::vector<CarvingView> viewsOf(const std::vector<silhouette::Silhouette>& silhouettes) {
  std::vector<CarvingView> out;
  for (const silhouette::Silhouette& s : silhouettes) out.push_back({&s, silhouette::SilhouetteDistance(s.coverage)});
  return out;
}

TriangleMesh hullOf(const std::vector<silhouette::Silhouette>& silhouettes, double voxel_m = 0.01,
                    double adaptivity = 0) {
  const auto views = viewsOf(silhouettes);
  auto hull = volumetricHull(views, {voxel_m, adaptivity});
  EXPECT_TRUE(hull.ok()) << (hull.ok() ? "" : hull.error().message);
  return hull.ok() ? hull.value().mesh : TriangleMesh();
}

TEST(VolumetricHull, BoxComesCloserToTheExactHullWithSmallerVoxels) {
  const Shape shape = boxShape({-0.2, -0.3, -0.15}, {0.2, 0.3, 0.15});
  const Rig rig(axisCameras(), shape);
  const double exact = hullVolume(rig, shape, 0.4);
  double last = 1;
  for (const double voxel_m : {0.06, 0.03, 0.01}) {
    const TriangleMesh mesh = hullOf(rig.silhouettes(), voxel_m);
    const MeshReport report = checkMesh(mesh);
    EXPECT_TRUE(report.solid()) << describe(report);
    const double error = std::abs(report.volume_m3 / exact - 1);
    EXPECT_LT(error, last) << voxel_m;
    last = error;
  }
  EXPECT_LT(last, 0.01);
}

TEST(VolumetricHull, BallIsContained) {
  const Shape shape = ballShape({0, 0, 0}, 0.4);
  const Rig rig(ringCameras(8), shape);
  const TriangleMesh mesh = hullOf(rig.silhouettes(), 0.015);
  const MeshReport report = checkMesh(mesh);
  EXPECT_TRUE(report.solid()) << describe(report);
  EXPECT_EQ(report.euler, 2);
  EXPECT_NEAR(report.volume_m3 / hullVolume(rig, shape, 0.6), 1, 0.01);
  for (const glm::vec3& p : mesh.positions) EXPECT_GT(glm::length(p), 0.394f);
}

TEST(VolumetricHull, TheHoleOfATorusStaysOpen) {
  auto cameras = sixCameras();
  cameras.push_back(lookingAt({0, 0, 0}, {0.3, 3, 0.2}));
  const TriangleMesh mesh = hullOf(Rig(cameras, torusShape(0.45, 0.15)).silhouettes(), 0.02);
  const MeshReport report = checkMesh(mesh);
  EXPECT_TRUE(report.solid()) << describe(report);
  EXPECT_EQ(report.euler, 0);
}

TEST(VolumetricHull, AdaptiveMeshingSavesFacesForALittleVolume) {
  const auto silhouettes = Rig(ringCameras(8), ballShape({0, 0, 0}, 0.4)).silhouettes();
  const TriangleMesh fine = hullOf(silhouettes, 0.015, 0), coarse = hullOf(silhouettes, 0.015, 0.1);
  EXPECT_LT(coarse.faces.size(), fine.faces.size() / 2);
  EXPECT_NEAR(checkMesh(coarse).volume_m3 / checkMesh(fine).volume_m3, 1, 0.03);
  EXPECT_TRUE(checkMesh(coarse).solid()) << describe(checkMesh(coarse));
}

TEST(VolumetricHull, TwoPerformersStayTwo) {
  const Shape shape = either(ballShape({-0.35, 0, 0}, 0.2), ballShape({0.35, 0, 0}, 0.2));
  const MeshReport report = checkMesh(hullOf(Rig(ringCameras(8), shape).silhouettes(), 0.015));
  EXPECT_TRUE(report.solid()) << describe(report);
  EXPECT_EQ(report.components, 2);
}

TEST(VolumetricHull, SpecksAreDropped) {
  const Shape shape = either(ballShape({0, 0, 0}, 0.3), ballShape({0.5, 0.2, 0}, 0.012));
  const TriangleMesh mesh = hullOf(Rig(ringCameras(8), shape).silhouettes(), 0.008);
  EXPECT_GT(mesh.faces.size(), 1000u);
  for (const glm::vec3& p : mesh.positions) EXPECT_LT(p.x, 0.45f);
}

TEST(VolumetricHull, NothingIsLeftWhereOnlyTwoOppositeCamerasSee) {
  const TriangleMesh mesh = hullOf(Rig(ringCameras(4), ballShape({0, 0, 0}, 0.4)).silhouettes(), 0.02);
  EXPECT_GT(mesh.faces.size(), 1000u);
  for (const glm::vec3& p : mesh.positions) EXPECT_LT(glm::length(p), 0.8f);
}

TEST(VolumetricHull, ACameraInsideTheBoxsSlabCarvesAsTheOthersDo) {
  // A camera between the planes of the box's top and bottom, which sees a side as a strip.
  const Shape shape = boxShape({-0.3, -0.2, -0.3}, {0.3, 0.2, 0.3});
  auto cameras = axisCameras();
  cameras.push_back(lookingAt({0, 0.1, 0}, {1.2, 0.1, 1.5}));
  const Rig rig(cameras, shape);
  const MeshReport report = checkMesh(hullOf(rig.silhouettes(), 0.015));
  EXPECT_TRUE(report.solid()) << describe(report);
  EXPECT_NEAR(report.volume_m3 / hullVolume(rig, shape, 0.5), 1, 0.015);
}

TEST(VolumetricHull, WhatACameraDoesNotSeeItDoesNotCarve) {
  auto cameras = ringCameras(8);
  const Shape shape = ballShape({0, 0, 0}, 0.4);
  const TriangleMesh before = hullOf(Rig(cameras, shape).silhouettes(), 0.015);
  const double whole = checkMesh(before).volume_m3;
  cameras.push_back(lookingAt({0, 0.45, 0}, {0, 0.9, 2}, 240, 240, 900));  // sees the upper part only
  const TriangleMesh mesh = hullOf(Rig(cameras, shape).silhouettes(), 0.015);
  const double volume = checkMesh(mesh).volume_m3;
  EXPECT_LT(volume, whole * 1.001);
  EXPECT_GT(volume, 4.0 / 3 * 3.14159 * 0.4 * 0.4 * 0.4);
  float lowest = 1;
  for (const glm::vec3& p : mesh.positions) lowest = std::min(lowest, p.y);
  EXPECT_LT(lowest, -0.4f);
  // Its picture's border makes neither a cut nor a step: every vertex of the hull without this camera that lies outside
  // its view is unchanged.
  const PinholeCamera& camera = cameras.back();
  size_t unseen = 0;
  for (const glm::vec3& p : before.positions) {
    const glm::dvec3 q = camera.project(glm::dvec3(p));
    if (q.x > -1 && q.y > -1 && q.x < camera.width + 1 && q.y < camera.height + 1) continue;
    ++unseen;
    EXPECT_TRUE(meshHolds(mesh, glm::dvec3(p) * 0.98)) << p.x << " " << p.y << " " << p.z;
    if (unseen >= 300) break;
  }
  EXPECT_EQ(unseen, 300u);
}

TEST(VolumetricHull, TheCameraThatDisagreesIsNamed) {
  auto silhouettes = Rig(ringCameras(8), ballShape({0, 0, 0}, 0.2)).silhouettes();
  silhouettes[5].coverage = coverageOf(silhouettes[5].camera, ballShape({0.5, 0.45, 0.3}, 0.1));
  const auto hull = volumetricHull(viewsOf(silhouettes), {0.01, 0});
  ASSERT_FALSE(hull.ok());
  EXPECT_EQ(hull.error().id, ErrorId::NothingVisible);
  EXPECT_NE(hull.error().message.find("\"cam05\""), std::string::npos) << hull.error().message;
}

TEST(VolumetricHull, CamerasWithoutACommonVolumeAreRefused) {
  std::vector<silhouette::Silhouette> silhouettes;
  for (const PinholeCamera& inwards : ringCameras(6)) {
    const glm::dvec3 from = inwards.centreInWorld();
    const PinholeCamera outwards = lookingAt(2.0 * from, from, 240, 240);
    silhouettes.push_back({outwards, coverageOf(outwards, ballShape(1.5 * from, 0.2))});
  }
  const auto hull = volumetricHull(viewsOf(silhouettes), {0.01, 0});
  ASSERT_FALSE(hull.ok());
  EXPECT_NE(hull.error().message.find("more than half of the cameras"), std::string::npos) << hull.error().message;
}

}  // namespace
}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/polyhedral_hull.h"

#include <gtest/gtest.h>

#include "reconstruct/mesh_checks.h"
#include "silhouette_fixture.h"

namespace fourdvt::reconstruct {
namespace {

constexpr double kTolerances_px[] = {8, 4, 2, 1, 0.5, 0.25};
const BoundingBox kBounds_m{glm::vec3(-1), glm::vec3(1)};

PolyhedralHull hullOf(const std::vector<SilhouetteCone>& cones, const BoundingBox& bounds = kBounds_m) {
  auto hull = polyhedralHull(cones, bounds);
  EXPECT_TRUE(hull.ok()) << hull.error().message;
  return hull ? hull.take() : PolyhedralHull{};
}

// Counts points in the bounds that only one of mesh and cones' polygons contains.
int disagreements(const TriangleMesh& mesh, const std::vector<SilhouetteCone>& cones, int count,
                  const BoundingBox& bounds = kBounds_m) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.001, 0.999);
  int wrong = 0;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 at(share(random), share(random), share(random));
    const glm::dvec3 p = glm::mix(glm::dvec3(bounds.min), glm::dvec3(bounds.max), at);
    wrong += meshHolds(mesh, p) != conesHold(cones, p);
  }
  return wrong;
}

void expectSolidAtAllTolerances(const Rig& rig, const char* name, const BoundingBox& bounds = kBounds_m) {
  for (double tolerance_px : kTolerances_px) {
    SCOPED_TRACE(std::string(name) + " at " + std::to_string(tolerance_px) + " px");
    const auto cones = rig.cones(tolerance_px);
    const PolyhedralHull hull = hullOf(cones, bounds);
    const MeshReport report = checkMesh(hull.mesh);
    EXPECT_TRUE(report.solid()) << describe(report);
    EXPECT_GT(report.volume_m3, 0);
    EXPECT_EQ(disagreements(hull.mesh, cones, 400, bounds), 0);
  }
}

void expectVolumeConverges(const Rig& rig, const Shape& shape, double share_at_1_px = 0.03) {
  const double ideal_m3 = hullVolume(rig, shape, 1, 100);
  ASSERT_GT(ideal_m3, 0.01);
  const auto error = [&](double tolerance_px) {
    return std::abs(checkMesh(hullOf(rig.cones(tolerance_px)).mesh).volume_m3 / ideal_m3 - 1);
  };
  EXPECT_LT(error(8), 0.3);
  EXPECT_LT(error(1), share_at_1_px);
  EXPECT_LT(error(0.25), 0.01);
  EXPECT_LT(error(0.25), error(8));
}

TEST(PolyhedralHull, BallIsSolidAndItsVolumeConverges) {
  const Shape ball = ballShape({0.05, 0, -0.02}, 0.5);
  const Rig rig(sixCameras(), ball);
  expectSolidAtAllTolerances(rig, "ball");
  expectVolumeConverges(rig, ball);
}

TEST(PolyhedralHull, BoxIsSolidAndItsVolumeConverges) {
  const Shape box = boxShape({-0.4, -0.3, -0.5}, {0.4, 0.3, 0.5});
  const Rig rig(sixCameras(), box);
  expectSolidAtAllTolerances(rig, "box");
  expectVolumeConverges(rig, box);
}

TEST(PolyhedralHull, UprightBoxSeenAlongTheAxes) {
  const Shape box = boxShape({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
  const Rig rig(axisCameras(), box);
  expectSolidAtAllTolerances(rig, "upright box");
  expectVolumeConverges(rig, box);
}

TEST(PolyhedralHull, CamerasBetweenTheBoxesPlanes) {
  // The cameras see neither top nor bottom, and some planes contain an edge of the box.
  const Shape slab = boxShape({-0.6, -0.1, -0.6}, {0.6, 0.1, 0.6});
  std::vector<PinholeCamera> cameras;
  for (const glm::dvec3& from :
       {glm::dvec3(3, 0, 0), {-3, 0.05, 0}, {0, 0.1, 3}, {0, -0.1, -3}, {0.6, 0, 2.5}, {0, 3, 0}})
    cameras.push_back(lookingAt(glm::dvec3(0), from));
  const Rig rig(cameras, slab);
  expectSolidAtAllTolerances(rig, "slab");
  expectVolumeConverges(rig, slab, 0.06);  // a pixel is a twentieth of its thickness
}

TEST(PolyhedralHull, TorusKeepsItsHole) {
  std::vector<PinholeCamera> cameras{lookingAt(glm::dvec3(0), {0, 3, 0.01})};
  for (int k = 0; k < 5; ++k) {
    const double azimuth = 1.2566 * k + 0.2;
    cameras.push_back(lookingAt(glm::dvec3(0), {2 * std::sin(azimuth), 2.2, 2 * std::cos(azimuth)}));
  }
  const Rig rig(cameras, torusShape(0.5, 0.15));
  const BoundingBox bounds{glm::vec3(-0.75f), glm::vec3(0.75f)};  // entirely inside all pictures
  expectSolidAtAllTolerances(rig, "torus", bounds);
  for (double tolerance_px : {2.0, 1.0, 0.5}) {
    const MeshReport report = checkMesh(hullOf(rig.cones(tolerance_px), bounds).mesh);
    EXPECT_EQ(report.euler, 0) << describe(report);
    EXPECT_EQ(report.components, 1);
  }
}

TEST(PolyhedralHull, TwoObjectsAreTwoComponents) {
  const Rig rig(sixCameras(), either(ballShape({0.45, 0.1, 0}, 0.2), boxShape({-0.6, -0.3, -0.1}, {-0.3, 0, 0.2})));
  expectSolidAtAllTolerances(rig, "two objects");
  const MeshReport report = checkMesh(hullOf(rig.cones(1)).mesh);
  EXPECT_EQ(report.components, 2);
  EXPECT_EQ(report.euler, 4);
}

TEST(PolyhedralHull, PerformerCutByThePicturesBorderIsNotCarvedThere) {
  std::vector<PinholeCamera> cameras = sixCameras();
  cameras[0].cx -= 150;  // the left half of the ball lies outside the picture
  cameras[3].cy += 110;
  const Shape ball = ballShape(glm::dvec3(0), 0.5);
  const Rig rig(cameras, ball);
  expectSolidAtAllTolerances(rig, "cut ball");
  const TriangleMesh mesh = hullOf(rig.cones(0.5)).mesh;
  for (double angle = 0; angle < 6.28; angle += 0.1)
    EXPECT_TRUE(meshHolds(mesh, 0.48 * glm::dvec3(std::cos(angle), std::sin(angle), 0)));
}

TEST(PolyhedralHull, NothingIsCarvedBehindACamera) {
  // The second camera looks past the ball; its picture is all background.
  const Shape ball = ballShape(glm::dvec3(0), 0.5);
  Rig rig({lookingAt(glm::dvec3(0), {0, 0, 3})}, ball);
  const double before_m3 = checkMesh(hullOf(rig.cones(1)).mesh).volume_m3;
  rig.cameras.push_back(lookingAt({3, 0, 0.2}, {1.2, 0, 0.2}));
  rig.coverages.push_back(Image(320, 240, 1, 0));
  EXPECT_NEAR(checkMesh(hullOf(rig.cones(1)).mesh).volume_m3, before_m3, 1e-6);
  // Rotated so that the bounds lie partly behind it and partly in front.
  for (double azimuth = 0.05; azimuth < 6.28; azimuth += 0.4) {
    const glm::dvec3 from(1.2, 0, 0.2), along(std::sin(azimuth), 0.2, std::cos(azimuth));
    rig.cameras.back() = lookingAt(from + along, from, 320, 240, 100);
    const auto cones = rig.cones(1);
    const PolyhedralHull hull = hullOf(cones);
    EXPECT_TRUE(checkMesh(hull.mesh).solid()) << describe(checkMesh(hull.mesh));
    EXPECT_EQ(disagreements(hull.mesh, cones, 500), 0) << azimuth;
  }
}

TEST(PolyhedralHull, CameraOnAnothersOutline) {
  // The second camera is visible right on an edge of the first one's outline: the edge's plane almost contains both
  // centres.
  const Shape ball = ballShape(glm::dvec3(0), 0.5);
  const Rig first({lookingAt(glm::dvec3(0), {0, 0, 3})}, ball);
  for (double tolerance_px : {8.0, 1.0}) {
    const silhouette::Ring ring = first.cones(tolerance_px)[0].outline.rings.back();
    for (double share : {0.0, 0.5, 0.501}) {
      const glm::dvec3 ray = rayInWorld(first.cameras[0], glm::mix(ring[0], ring[1], share));
      const glm::dvec3 from = first.cameras[0].centreInWorld() + 6.0 * ray;
      const Rig rig({first.cameras[0], lookingAt(glm::dvec3(0), from), lookingAt(glm::dvec3(0), {3, 0.5, 0})}, ball);
      const auto cones = rig.cones(tolerance_px);
      const PolyhedralHull hull = hullOf(cones);
      EXPECT_TRUE(checkMesh(hull.mesh).solid()) << describe(checkMesh(hull.mesh));
      EXPECT_EQ(disagreements(hull.mesh, cones, 500), 0) << share;
    }
  }
}

TEST(PolyhedralHull, SaysWhetherTheBoundsCutIt) {
  const Shape ball = ballShape(glm::dvec3(0), 0.5);
  EXPECT_FALSE(hullOf(Rig(sixCameras(), ball).cones(1)).touches_bounds);
  const auto one = Rig({sixCameras()[0]}, ball).cones(1);
  const PolyhedralHull hull = hullOf(one);
  EXPECT_TRUE(hull.touches_bounds);
  EXPECT_TRUE(checkMesh(hull.mesh).solid());
}

TEST(PolyhedralHull, EmptyPictureLeavesNothingAndFullOneEverything) {
  const PinholeCamera camera = sixCameras()[0];
  EXPECT_TRUE(hullOf({{camera, silhouette::outlineOf(Image(320, 240, 1, 0))}}, {glm::vec3(-0.3f), glm::vec3(0.3f)})
                  .mesh.faces.empty());
  const PolyhedralHull all = hullOf({{camera, silhouette::outlineOf(Image(320, 240, 1, 255))}});
  EXPECT_EQ(all.mesh.faces.size(), 12u);
  EXPECT_NEAR(checkMesh(all.mesh).volume_m3, 8, 1e-4);
}

TEST(PolyhedralHull, OutlinesWithHolesInANoisyMatteStaySolid) {
  // Random blobs of background and performer: hundreds of rings, hulls with many tunnels and islands.
  Rig rig(sixCameras(160, 120, 150), ballShape(glm::dvec3(0), 0.6));
  std::mt19937 random(3);
  for (Image& coverage : rig.coverages)
    for (int blob = 0; blob < 60; ++blob) {
      const int x0 = int(random() % 158), y0 = int(random() % 118), value = int(random() % 256);
      for (int k = 0; k < 9; ++k) *coverage.at(x0 + k % 3, y0 + k / 3) = uint8_t(value);
    }
  for (double tolerance_px : {0.5, 1.0, 2.0}) {
    const auto cones = rig.cones(tolerance_px);
    const PolyhedralHull hull = hullOf(cones);
    const MeshReport report = checkMesh(hull.mesh);
    EXPECT_TRUE(report.solid()) << describe(report);
    EXPECT_EQ(disagreements(hull.mesh, cones, 300), 0);
  }
}

TEST(PolyhedralHull, SameInputSameMesh) {
  const auto cones = Rig(axisCameras(), boxShape(glm::dvec3(-0.5), glm::dvec3(0.5))).cones(1);
  const TriangleMesh a = hullOf(cones).mesh, b = hullOf(cones).mesh;
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.faces, b.faces);
}

TEST(PolyhedralHull, RefusesCamerasItCannotUse) {
  const auto error = [](const std::vector<SilhouetteCone>& cones, const BoundingBox& bounds = kBounds_m) {
    const auto hull = polyhedralHull(cones, bounds);
    return hull.ok() ? ErrorId::None : hull.error().id;
  };
  const SilhouetteCone good{sixCameras()[0], silhouette::outlineOf(Image(320, 240, 1, 0))};
  EXPECT_EQ(error({good}), ErrorId::None);
  EXPECT_EQ(error({}), ErrorId::InvalidArgument);
  EXPECT_EQ(error({good, good}), ErrorId::InvalidArgument);
  EXPECT_EQ(error({good}, {glm::vec3(1), glm::vec3(-1)}), ErrorId::InvalidArgument);
  EXPECT_EQ(error({good}, {glm::vec3(-5), glm::vec3(5)}), ErrorId::InvalidArgument);
  SilhouetteCone broken = good;
  broken.camera.cam_from_world[3][0] = NAN;
  EXPECT_EQ(error({broken}), ErrorId::InvalidArgument);
  broken = good;
  broken.outline.rings[0][0].x = NAN;
  EXPECT_EQ(error({broken}), ErrorId::InvalidArgument);
}

TEST(PolyhedralHull, OutlineThatCrossesItselfIsAnErrorOrStillSolid) {
  auto cones = Rig(sixCameras(), ballShape(glm::dvec3(0), 0.5)).cones(4);
  std::swap(cones[0].outline.rings.back()[1], cones[0].outline.rings.back()[3]);
  const auto hull = polyhedralHull(cones, kBounds_m);
  if (!hull.ok()) {
    EXPECT_EQ(hull.error().id, ErrorId::Internal);
  } else {
    EXPECT_TRUE(checkMesh(hull.value().mesh).closed());
  }
}

}  // namespace
}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
#include "refine/camera_fit.h"

#include <gtest/gtest.h>

#include "sphere_fixture.h"

namespace fourdvt::refine {
namespace {

constexpr double kRadians = 3.14159265358979323846 / 180;

// A ball with two smaller ones beside it, so that rotation about the optical axis is visible.
BallMesh figure(double grown) {
  BallMesh mesh = ballMesh(0.3 + grown, 3);
  for (const glm::vec3& at : {glm::vec3(0.35f, 0.2f, 0), glm::vec3(-0.3f, -0.3f, 0.1f)}) {
    const BallMesh small = ballMesh(0.12 + grown, 3);
    const uint32_t first = uint32_t(mesh.positions.size());
    for (const glm::vec3& p : small.positions) mesh.positions.push_back(p + at);
    for (const glm::uvec3& f : small.faces) mesh.faces.push_back(f + first);
  }
  computeVertexNormals(mesh.faces, mesh.positions.data(), mesh.positions.size(), mesh.normals);
  mesh.edges = innerEdges(mesh.faces);
  return mesh;
}

// Matte of the figure in a camera: the balls' discs, drawn by projecting points of their surfaces.
MatteCrop matteOf(const PinholeCamera& camera) {
  const struct {
    glm::dvec3 centre;
    double radius;
  } balls[] = {{{0, 0, 0}, 0.3}, {{0.35, 0.2, 0}, 0.12}, {{-0.3, -0.3, 0.1}, 0.12}};
  MatteCrop matte;
  matte.alpha = Image(kBallPicture, kBallPicture, 1);
  constexpr int kSub = 4;
  const glm::dmat4 world_from_cam = glm::inverse(camera.cam_from_world);
  const glm::dvec3 eye = camera.centreInWorld();
  for (int y = 0; y < kBallPicture; ++y)
    for (int x = 0; x < kBallPicture; ++x) {
      int inside = 0;
      for (int s = 0; s < kSub * kSub; ++s) {
        const double u = x + (s % kSub + 0.5) / kSub, v = y + (s / kSub + 0.5) / kSub;
        const glm::dvec3 ray = glm::normalize(glm::dmat3(world_from_cam) *
                                              glm::dvec3((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1));
        for (const auto& ball : balls) {
          const glm::dvec3 to = ball.centre - eye;
          if (glm::length(glm::cross(ray, to)) > ball.radius) continue;
          ++inside;
          break;
        }
      }
      *matte.alpha.at(x, y) = uint8_t(255 * inside / (kSub * kSub));
    }
  return matte;
}

std::vector<BlockedPoint> pointsOf(const BallMesh& mesh, const PinholeCamera& camera, const MatteCrop& matte) {
  std::vector<BlockedPoint> out;
  OutlineOptions options;
  options.reach_pixels = 30;
  for (const OutlinePoint& s :
       outlinePoints(camera, mesh.faces, mesh.edges, mesh.positions, mesh.normals, matte, options)) {
    const glm::ivec3 cube = glm::floor(mesh.positions[s.from] / 0.15f) + 8.0f;
    out.push_back({s, uint32_t(cube.x * 256 + cube.y * 16 + cube.z)});
  }
  return out;
}

struct Fit {
  PinholeCamera camera;
  CameraStep last;
};

Fit fit(const BallMesh& mesh, PinholeCamera camera, const MatteCrop& matte, Freedom freedom) {
  const PinholeCamera given = camera;
  CameraStep step;
  for (int i = 0; i < 8; ++i) {
    step = fitCamera(camera, given, pointsOf(mesh, camera, matte), freedom);
    EXPECT_TRUE(step.solvable);
    camera = changed(camera, step.change);
  }
  return {camera, step};
}

double pixelsApart(const PinholeCamera& a, const PinholeCamera& b, const BallMesh& mesh) {
  double most = 0;
  for (const glm::vec3& p : mesh.positions)
    most = std::max(most, glm::length(glm::dvec2(a.project(glm::dvec3(p)) - b.project(glm::dvec3(p)))));
  return most;
}

TEST(CameraFit, ChangeTurnsMovesAndZooms) {
  const PinholeCamera camera = ballCamera(1, 8);
  const PinholeCamera moved = changed(camera, {{0, 0, 0}, {0.1, 0, 0}, std::log(2.0)});
  EXPECT_NEAR(glm::length(moved.centreInWorld() - camera.centreInWorld()), 0.1, 1e-9);
  EXPECT_NEAR(moved.fx, 2 * camera.fx, 1e-9);
  const PinholeCamera turned = changed(camera, {{0, 0.1, 0}, {0, 0, 0}, 0});
  EXPECT_NEAR(glm::dot(turned.forwardInWorld(), camera.forwardInWorld()), std::cos(0.1), 1e-9);
  EXPECT_NEAR(glm::length(turned.centreInWorld() - camera.centreInWorld()), 0, 1e-9);
}

TEST(CameraFit, TurnedCameraIsTurnedBack) {
  const PinholeCamera truth = ballCamera(0, 8);
  const MatteCrop matte = matteOf(truth);
  const BallMesh mesh = figure(0);
  for (const glm::dvec3& turn : {glm::dvec3(0.1, -0.1, 0.3), glm::dvec3(-0.5, 0.3, -1)}) {
    const PinholeCamera given = changed(truth, {turn * kRadians, {0, 0, 0}, 0});
    ASSERT_GT(pixelsApart(given, truth, mesh), 3);
    EXPECT_LT(pixelsApart(fit(mesh, given, matte, Freedom{}).camera, truth, mesh), 0.25);
  }
}

TEST(CameraFit, MeshThatIsTooLargeAllOverDoesNotTurnTheCamera) {
  const PinholeCamera truth = ballCamera(0, 8);
  const BallMesh mesh = figure(0.003);
  const Fit result = fit(mesh, truth, matteOf(truth), Freedom{.place = true});
  EXPECT_LT(pixelsApart(result.camera, truth, mesh), 0.25);
  EXPECT_NEAR(result.camera.fx / truth.fx, 1, 0.001);
}

TEST(CameraFit, FocalLengthIsFoundWhereItIsFree) {
  const PinholeCamera truth = ballCamera(0, 8);
  const BallMesh mesh = figure(0);
  PinholeCamera given = truth;
  given.fx = given.fy = truth.fx * 1.006;
  ASSERT_GT(pixelsApart(given, truth, mesh), 1.2);
  EXPECT_LT(pixelsApart(fit(mesh, given, matteOf(truth), Freedom{.place = true}).camera, truth, mesh), 0.5);
}

TEST(CameraFit, FocalLengthIsHeldNearTheGivenOneHoweverManySteps) {
  // 2 % is ten times the calibration error of usual rigs.
  const PinholeCamera truth = ballCamera(0, 8);
  const BallMesh mesh = figure(0);
  PinholeCamera given = truth;
  given.fx = given.fy = truth.fx * 1.02;
  const MatteCrop matte = matteOf(truth);
  const PinholeCamera once = fit(mesh, given, matte, Freedom{.place = true}).camera;
  CameraStep step;
  PinholeCamera often = once;
  for (int i = 0; i < 12; ++i) {
    step = fitCamera(often, given, pointsOf(mesh, often, matte), Freedom{.place = true});
    often = changed(often, step.change);
  }
  EXPECT_NEAR(often.fx, once.fx, 0.002 * truth.fx);
  EXPECT_GT(often.fx, truth.fx);
}

TEST(CameraFit, SaysHowSureItIs) {
  const PinholeCamera truth = ballCamera(0, 8);
  auto points = pointsOf(figure(0), truth, matteOf(truth));
  const double clean = fitCamera(truth, truth, points, Freedom{}).shift_deviation_pixels;
  EXPECT_LT(clean, 0.12);
  // Each block's points share an error of up to a pixel: the same number of points has less information.
  for (BlockedPoint& s : points) s.point.residual_pixels += float(s.block * 7 % 5) * 0.5f - 1;
  EXPECT_GT(fitCamera(truth, truth, points, Freedom{}).shift_deviation_pixels, 2 * clean);
}

TEST(CameraFit, FewSamplesAreNotSolvable) {
  EXPECT_FALSE(fitCamera(ballCamera(0, 8), ballCamera(0, 8), {}, Freedom{}).solvable);
}

TEST(CameraFit, ShiftIsTheRootMeanSquareInThePicture) {
  const PinholeCamera a = ballCamera(0, 8);
  PinholeCamera b = a;
  b.cx += 3;
  b.cy += 4;
  const auto points = pointsOf(figure(0), a, matteOf(a));
  EXPECT_NEAR(shiftPixels(a, b, points), 5, 1e-6);
  EXPECT_EQ(shiftPixels(a, b, {}), 0);
}

}  // namespace
}  // namespace fourdvt::refine

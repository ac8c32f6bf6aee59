// SPDX-License-Identifier: Apache-2.0
// Montage4D and the blend that it is compared with: votes on painted colours, dilated depth discontinuities, the seams
// of two cameras round a cylinder, fields that follow an abrupt turn, unseen surface, and reuse from view to view.
#include <cmath>

#include "camera_figure.h"
#include "surface_rig.h"

namespace fourdvt::testing {
namespace {

class MontageTest : public CameraFigure {
 protected:
  void use(const char* name) { recipe_->setMethod(render::makeCameraMethod(*device, name).take()); }

  glm::ivec3 shown(const PinholeCamera& view, const dvec3& point) {
    const dvec3 at = view.project(point);
    const Image image = still(view);
    const uint8_t* p = image.at(int(at.x), int(at.y));
    EXPECT_EQ(p[3], 255);
    return {p[0], p[1], p[2]};
  }

  // Wall that three cameras see in these colours.
  void makePaintedWall(const std::vector<glm::u8vec4>& colors) {
    addQuad({0, 1, 0}, 0.5, 12);
    std::vector<Image> pictures;
    for (size_t c = 0; c < colors.size(); ++c) {
      cameras_.push_back(lookAt({-0.8 + 0.8 * double(c), 1, 3}, {0, 1, 0}, kSide, kSide, 60));
      pictures.push_back(filled(cameras_.back(), colors[c]));
    }
    makeModel();
    tile(pictures, {{4, 4}, {100, 4}, {4, 100}});
  }
  const PinholeCamera front_ = lookAt({0.1, 1, 2.6}, {0, 1, 0}, 96, 96, 100);
};

void expectNear(const glm::ivec3& color, const glm::u8vec4& expected, int within) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(color[k], expected[k], within) << k;
}

TEST_F(MontageTest, AColourThatMostOthersDoNotShareIsOutvoted) {
  makePaintedWall({kRed, kRed + glm::u8vec4(6, 6, 6, 0), kBlue});
  use("holoportation");
  expectNear(shown(front_, {0, 1, 0}), kRed, 7);
  options_.method.montage.vote_threshold = 0;
  EXPECT_GT(shown(front_, {0, 1, 0}).b, kRed.b + 40) << "without a vote blue comes in";
  use("montage4d");
  options_.method.montage.vote_threshold = 0.15f;
  EXPECT_GT(shown(front_, {0, 1, 0}).b, kRed.b + 20) << "far from occlusions there is no vote";
}

TEST_F(MontageTest, WhereNobodyAgreesTheBlendIsThePlainOne) {
  makePaintedWall({kRed, kBlue});
  use("holoportation");
  const glm::ivec3 color = shown(front_, {0, 1, 0});
  EXPECT_NEAR(color.r, (kRed.r + kBlue.r) / 2, 20);
  EXPECT_NEAR(color.b, (kRed.b + kBlue.b) / 2, 20);
}

TEST_F(MontageTest, TheViewsOwnCameraLeads) {
  makePaintedWall({kRed, kBlue});
  const PinholeCamera left = lookAt({-0.8, 1, 2.6}, {0, 1, 0}, 96, 96, 100);
  use("holoportation");
  const int by_normals = shown(left, {0, 1, 0}).b;
  use("montage4d");
  EXPECT_LT(shown(left, {0, 1, 0}).b, by_normals - 20);
}

// The screen is larger in the left camera's picture than on the surface: its blue falls onto the wall beside it, but
// not with dilated discontinuities, since the right camera sees the wall there.
TEST_F(MontageTest, NothingBesideAnOccludersOutlineIsTakenFromThatCamera) {
  addQuad({0, 1, 0}, 0.5, 24);
  addQuad({0, 1, 0.5}, 0.12, 4);
  cameras_ = {lookAt({-0.5, 1, 3}, {0, 1, 0}, kSide, kSide, 60), lookAt({1.6, 1, 2.6}, {0, 1, 0}, kSide, kSide, 60)};
  Image left = filled(cameras_[0], kRed);
  const dvec3 low = cameras_[0].project({-0.12, 1.12, 0.5}), high = cameras_[0].project({0.12, 0.88, 0.5});
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      if (x > low.x - 2.5 && x < high.x + 2.5 && y > low.y - 2.5 && y < high.y + 2.5)
        for (int k = 0; k < 4; ++k) left.at(x, y)[k] = kBlue[k];
  makeModel();
  tile({left, filled(cameras_[1], kRed)}, {{4, 4}, {100, 4}});
  const auto bluest = [&] {
    int blue = 0;
    const PinholeCamera view = lookAt({-2.6, 1, 1.6}, {0, 1, 0}, 128, 128, 130);
    const Image image = still(view);
    for (double x = 0.0; x < 0.5; x += 0.01)
      for (double y = 0.7; y < 1.3; y += 0.01) {
        if (glm::length(glm::dvec2(x, y - 1)) < 0.02) continue;
        const dvec3 at = view.project({x, y, 0});
        blue = std::max(blue, int(image.at(int(at.x), int(at.y))[2]));
      }
    return blue;
  };
  options_.method.montage.vote_threshold = 0;
  for (const char* name : {"holoportation", "montage4d"}) {
    use(name);
    options_.method.montage.discontinuity_px = 4;
    EXPECT_LT(bluest(), 60) << name;
    options_.method.montage.discontinuity_px = 0;
    EXPECT_GT(bluest(), 75) << name << ": the test's picture leaks without";
  }
}

TEST_F(MontageTest, TwoCamerasRoundACylinderHaveSeamsWhereTheyLoseIt) {
  const Surface cylinder = equilateral(96, 30, 0.013, true);
  positions_ = cylinder.positions;
  faces_ = cylinder.faces;
  cameras_ = {lookAt({0, 0, 3}, {0, 0, 0}, kSide, kSide, 60), lookAt({0, 0, -3}, {0, 0, 0}, kSide, kSide, 60)};
  makeModel();
  tile({filled(cameras_[0], kRed), filled(cameras_[1], kRed)}, {{4, 4}, {100, 4}});
  options_.method.min_cosine = 0.3f;
  const double radius = 96 * 0.013 / (2 * M_PI), lost = std::acos(0.3);  // where the cosine to the camera is that
  const auto colorAt = [&](double angle) {
    const dvec3 point(radius * std::sin(angle), 0, radius * std::cos(angle));
    const PinholeCamera view = lookAt(dvec3(9.0 * point.x, 0, 9.0 * point.z), {0, 0, 0}, 96, 96, 150);
    return shown(view, point);
  };
  use("montage4d-seams");
  for (const double side : {1.0, -1.0}) {
    const glm::ivec3 first = colorAt(side * (lost - 0.05)), second = colorAt(side * (M_PI - lost + 0.05));
    EXPECT_GT(first.r, first.g + 60) << "the first camera's colour";
    EXPECT_GT(second.g, second.r + 60) << "the second one's";
    const double beyond = lost - 0.2 / radius;  // farther than the clamp
    const glm::ivec3 far = colorAt(side * beyond);
    EXPECT_NEAR(far.r, far.g, 4) << "no seam is near";
  }
  use("montage4d-weights");
  const glm::ivec3 front = colorAt(0), back = colorAt(M_PI);
  EXPECT_GT(front.r, front.g + 100);
  EXPECT_GT(back.g, back.r + 60);
}

// An empty slot precedes those of the last two cameras.
TEST_F(MontageTest, ASlotWithoutACameraCountsForNone) {
  makePaintedWall({kRed, kRed, kBlue});
  options_.method.montage.vote_threshold = 0;
  const PinholeCamera left = lookAt({-0.8, 1, 2.6}, {0, 1, 0}, 96, 96, 100),
                      right = lookAt({0.7, 1, 2.6}, {0, 1, 0}, 96, 96, 100);
  for (const char* name : {"holoportation", "montage4d"}) {
    use(name);
    options_.method.closest = 2;
    const glm::ivec3 alone = shown(right, {0, 1, 0});
    use(name);
    options_.method.closest = 3;
    still(left);
    options_.method.closest = 2;
    const glm::ivec3 later = shown(right, {0, 1, 0});
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(later[k], alone[k], 1) << name;
  }
}

TEST_F(MontageTest, AnAbruptTurnFadesFromCameraToCamera) {
  makePaintedWall({kRed, kBlue});
  use("montage4d");
  options_.method.closest = 1;
  const PinholeCamera left = lookAt({-0.9, 1, 2.6}, {0, 1, 0}, 96, 96, 100),
                      right = lookAt({0.3, 1, 2.6}, {0.1, 1, 0}, 96, 96, 100);
  expectNear(shown(left, {0, 1, 0}), kRed, 2);
  options_.method.elapsed_s = 1.0f / 60;
  const double gone = 1 - std::exp(-1.0 / 60 / options_.method.montage.settling_s);
  EXPECT_NEAR(shown(right, {0, 1, 0}).b, kRed.b + gone * (kBlue.b - kRed.b), 4);
  options_.method.elapsed_s = 2;
  expectNear(shown(right, {0, 1, 0}), kBlue, 2);
  options_.method.elapsed_s = std::numeric_limits<float>::infinity();
  expectNear(shown(left, {0, 1, 0}), kRed, 2);
}

// A wall behind a screen, with a lower half that no camera sees: it takes the colours above it.
TEST_F(MontageTest, UnseenSurfaceTakesItsNeighbourhoodsColour) {
  addQuad({0, 1, 0}, 0.5, 16);
  addQuad({0, 0.3, 0.4}, 0.45);
  cameras_ = {lookAt({0, 1.4, 3}, {0, 1, 0}, 128, 128, 130)};
  Image picture = filled(cameras_[0], kRed);
  for (int y = 0; y < 128; ++y)  // the screen is blue
    for (int x = 0; x < 128; ++x)
      if (y > cameras_[0].project({0, 0.75, 0.4}).y)
        for (int k = 0; k < 4; ++k) picture.at(x, y)[k] = kBlue[k];
  makeModel();
  tile({picture}, {{20, 30}});
  options_.method.unseen = render::Unseen::Neighbourhood;
  for (const char* name : {"montage4d", "holoportation"}) {
    use(name);
    expectNear(shown(lookAt({0, 2.6, 1.2}, {0, 0.9, 0}, 128, 128, 110), {0, 0.54, 0}), kRed, 8);
  }
}

TEST_F(MontageTest, WhatTheViewDoesNotChangeIsKept) {
  makePaintedWall({kRed, kRed, kBlue});
  use("montage4d");
  const auto passes = [&](double x) {
    device->resetCounters();
    still(lookAt({x, 1, 2.6}, {0, 1, 0}, 96, 96, 100));
    return device->counters().passes;
  };
  EXPECT_GT(passes(0), 20u) << "distances";
  constexpr uint64_t kPicture = 3;  // the figure, what is round it, and both together
  EXPECT_EQ(passes(0.2), 2 + kPicture) << "what the view wants, what follows it, and the picture";
  model_.setPositions(*device, positions_);
  EXPECT_GT(passes(0.2), 20u);
  use("holoportation");
  EXPECT_EQ(passes(0), 4 + kPicture) << "three depth maps, the vote, and the picture";
  EXPECT_EQ(passes(0.2), kPicture);
}

TEST(MontageDevices, WithoutHalfFloatTargetsOnlyTheBaselineIsDrawn) {
  const auto device = gpu::createNullDevice(false);
  EXPECT_EQ(render::makeCameraMethod(*device, "montage4d").error().id, ErrorId::Unsupported);
  EXPECT_TRUE(render::makeCameraMethod(*device, "holoportation"));
}

}  // namespace
}  // namespace fourdvt::testing

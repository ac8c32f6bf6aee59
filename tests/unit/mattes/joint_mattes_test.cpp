// SPDX-License-Identifier: Apache-2.0
// Joint mattes of all cameras, on balls in a noisy room.
#include "mattes/joint_mattes.h"

#include <gtest/gtest.h>

#include "mattes/background_key.h"
#include "mattes/hints.h"
#include "mattes/reduced.h"
#include "mattes_fixture.h"

namespace fourdvt::mattes {
namespace {

const Ball kPerformer{{0, 0.05, 0}, 0.45, {200, 70, 60}, 25};
constexpr double kFloor_m = -0.5;

struct Scene {
  std::vector<capture::CaptureCamera> rig;
  std::vector<Image> pictures;
  std::vector<BackgroundModel> plates;

  explicit Scene(const std::vector<Ball>& balls, int cameras = 6) : rig(ringOf(cameras)) {
    for (int i = 0; i < int(rig.size()); ++i) {
      pictures.push_back(filmed(rig, i, balls, 7 + uint32_t(i)));
      std::vector<Image> empty;
      for (uint32_t k = 0; k < 4; ++k) empty.push_back(filmed(rig, i, {}, 100 + 10 * uint32_t(i) + k));
      plates.push_back(makeBackgroundModel(empty));
    }
  }
  std::vector<MatteView> views() const {
    std::vector<MatteView> out(rig.size());
    for (size_t i = 0; i < out.size(); ++i) out[i].picture = pictures[i], out[i].plates = &plates[i];
    return out;
  }
  std::vector<CameraMatte> make(const JointOptions& options = {}) const {
    return JointMattes(rig, kFloor_m, options).make(views());
  }
};

// The performer in front of six cameras; created once.
const Scene& performerScene() {
  static const Scene scene({kPerformer});
  return scene;
}

cv::Mat solid(const CameraMatte& matte) { return matrixOf(matte.matte) >= 128; }

TEST(JointMattes, AgreesWithTheTruth) {
  const Scene& scene = performerScene();
  const auto mattes = scene.make();
  for (size_t i = 0; i < mattes.size(); ++i) {
    EXPECT_GT(unionShare(solid(mattes[i]), maskOf(scene.rig[i], {kPerformer})), 0.98) << i;
    EXPECT_GT(mattes[i].supported, 0.98);
    EXPECT_GT(mattes[i].kept, 0.98);
  }
}

TEST(JointMattes, DropsWhatNoOtherCameraSees) {
  Scene scene = performerScene();
  // A person in the background, visible to camera 0 only.
  const Ball stranger{{1.3, 0.1, 0.1}, 0.3, {60, 70, 210}, 25};
  scene.pictures[0] = filmed(scene.rig, 0, {kPerformer, stranger}, 7);
  const cv::Mat truth = maskOf(scene.rig[0], {kPerformer}), other = maskOf(scene.rig[0], {stranger}) & ~truth;
  JointOptions alone;
  alone.alone = true;
  const auto mattes = scene.make();
  const cv::Mat by_itself = solid(scene.make(alone)[0]), together = solid(mattes[0]);
  EXPECT_GT(cv::countNonZero(by_itself & other), 0.9 * cv::countNonZero(other));
  EXPECT_LT(cv::countNonZero(together & other), 0.02 * cv::countNonZero(other));
  EXPECT_GT(unionShare(together, truth), 0.97);
  // The result reports this.
  EXPECT_LT(mattes[0].supported, 0.9);
  EXPECT_GT(cv::countNonZero((mattes[0].dropped == 255) & other), 0.8 * cv::countNonZero(other));
}

TEST(JointMattes, FillsWhatAllOthersDemand) {
  // Clothes of the room's colours.
  const Ball grey{kPerformer.centre, kPerformer.radius_m, {100, 92, 84}, 10};
  const Scene scene({grey}, 9);
  JointOptions without, strongly;
  without.demanded_nats = 0;
  strongly.demanded_nats = 0.5;
  double mean_without = 0, mean = 0;
  const auto loose = scene.make(without), filled = scene.make(strongly);
  for (size_t i = 0; i < scene.rig.size(); ++i) {
    const cv::Mat truth = maskOf(scene.rig[i], {grey});
    mean_without += unionShare(solid(loose[i]), truth) / 9;
    mean += unionShare(solid(filled[i]), truth) / 9;
  }
  EXPECT_GT(mean, mean_without + 0.001) << mean_without;
  EXPECT_GT(mean, 0.985);
}

TEST(JointMattes, TakesPatchesOnTheFloorForShadows) {
  Scene scene = performerScene();
  // A floor patch at a third of the plate's brightness, with a pattern of its own, so that each camera alone takes it
  // for an object. Visible to all cameras.
  std::vector<cv::Mat> patch;
  for (size_t i = 0; i < scene.rig.size(); ++i) {
    const PinholeCamera& c = scene.rig[i].pinhole;
    cv::Mat mask(kSide, kSide, CV_8U, cv::Scalar(0));
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const glm::dvec3 from = c.centreInWorld(), along = rayOf(c, x + 0.5, y + 0.5);
        if (along.y >= 0) continue;
        const glm::dvec3 on = from + along * ((kFloor_m - from.y) / along.y);
        if (std::hypot(on.x - 0.9, on.z) < 0.3) mask.at<uint8_t>(y, x) = 255;
      }
    mask &= ~maskOf(scene.rig[i], {kPerformer});
    for (int k = 0; k < int(mask.total()); ++k)
      if (mask.at<uint8_t>(k))
        for (size_t ch = 0; ch < 3; ++ch) {
          const int x = k % kSide, y = k / kSide;
          const double pattern = 20 * hashed(uint32_t(x / 2), uint32_t(y / 2), 7 + uint32_t(i)) - 10;
          scene.pictures[i].pixels[3 * size_t(k) + ch] =
              uint8_t(std::max(0.0, 0.4 * (roomLevel(int(i), x, y, int(ch)) + 14) - 14 + pattern));
        }
    patch.push_back(mask);
  }
  const auto together = scene.make();
  JointOptions without;
  without.floor = false;
  const auto no_floor = scene.make(without);
  double kept = 0, kept_without = 0, all = 0, explained = 0;
  for (size_t i = 0; i < scene.rig.size(); ++i) {
    kept += cv::countNonZero(solid(together[i]) & patch[i]);
    kept_without += cv::countNonZero(solid(no_floor[i]) & patch[i]);
    all += cv::countNonZero(patch[i]);
    explained += cv::countNonZero((together[i].dropped == 128) & patch[i]);
    EXPECT_GT(cv::countNonZero(solid(together[i]) & maskOf(scene.rig[i], {kPerformer})),
              0.97 * cv::countNonZero(maskOf(scene.rig[i], {kPerformer})));
  }
  EXPECT_GT(kept_without, 0.5 * all);
  EXPECT_LT(kept, 0.1 * all);
  EXPECT_GT(explained, 0.5 * all);
}

TEST(JointMattes, LeavesMattesOfTheCaptureAlone) {
  const Scene& scene = performerScene();
  auto views = scene.views();
  views[1].plates = nullptr;
  views[1].given = Image(kSide, kSide, 1);
  const cv::Mat truth = maskOf(scene.rig[1], {kPerformer});
  std::copy(truth.begin<uint8_t>(), truth.end<uint8_t>(), views[1].given.pixels.begin());
  for (int x = 0; x < 20; ++x) *views[1].given.at(x, 3) = 200;  // without support, but final
  views[1].given_is_final = true;
  const auto mattes = JointMattes(scene.rig, kFloor_m).make(views);
  EXPECT_EQ(mattes[1].matte.pixels, views[1].given.pixels);
  // A colour key's matte may lose pixels that other cameras contradict.
  views[1].given_is_final = false;
  const auto keyed = JointMattes(scene.rig, kFloor_m).make(views);
  EXPECT_EQ(*keyed[1].matte.at(5, 3), 0);
  EXPECT_EQ(keyed[1].dropped.at<uint8_t>(3, 5), 255);
  EXPECT_EQ(keyed[1].own.at<uint8_t>(3, 5), 255);
  EXPECT_LT(keyed[1].kept, 1);
  EXPECT_GT(unionShare(solid(keyed[1]), truth), 0.99);
}

TEST(JointMattes, ObeysHints) {
  const Scene& scene = performerScene();
  auto views = scene.views();
  cv::Mat cost(kSide, kSide, CV_32F, cv::Scalar(0));
  const glm::dvec3 middle = scene.rig[0].pinhole.project(kPerformer.centre);
  cost(cv::Rect(int(middle.x) - 3, int(middle.y) - 3, 7, 7)) = kObeyed;  // a hole
  cost(cv::Rect(4, 4, 12, 12)) = -kObeyed;                               // a patch of the room
  views[0].hints = cost;
  const auto mattes = JointMattes(scene.rig, kFloor_m).make(views);
  EXPECT_EQ(*mattes[0].matte.at(int(middle.x), int(middle.y)), 0);
  EXPECT_EQ(*mattes[0].matte.at(9, 9), 255);
  EXPECT_GT(unionShare(solid(mattes[1]), maskOf(scene.rig[1], {kPerformer})), 0.97);
}

TEST(JointMattes, CutsLargePicturesAsSmallOnes) {
  // 25 times as many pixels: cut at a reduced size, then refined along the outline.
  auto rig = ringOf(3);
  for (auto& c : rig) {
    PinholeCamera& p = c.pinhole;
    p.width *= 5, p.height *= 5, p.fx *= 5, p.fy *= 5, p.cx *= 5, p.cy *= 5;
  }
  std::vector<BackgroundModel> plates;
  std::vector<MatteView> views(rig.size());
  for (int i = 0; i < int(rig.size()); ++i) {
    plates.push_back(makeBackgroundModel(std::vector<Image>{filmed(rig, i, {}, 50 + uint32_t(i))}));
    views[size_t(i)].picture = filmed(rig, i, {kPerformer}, 60 + uint32_t(i));
  }
  for (size_t i = 0; i < rig.size(); ++i) views[i].plates = &plates[i];
  const auto mattes = JointMattes(rig, kFloor_m).make(views);
  for (size_t i = 0; i < rig.size(); ++i) {
    EXPECT_EQ(mattes[i].matte.width, 5 * kSide);
    EXPECT_GT(unionShare(solid(mattes[i]), maskOf(rig[i], {kPerformer})), 0.99) << i;
  }
}

TEST(KeyCut, JudgesByColoursWhereNoPlateShowsTheBackground) {
  const auto rig = ringOf(3);
  const Image picture = filmed(rig, 0, {kPerformer}, 3);
  BackgroundModel plate = makeBackgroundModel(std::vector<Image>{filmed(rig, 0, {}, 4)});
  const cv::Mat truth = maskOf(rig[0], {kPerformer});
  // The plate is unknown round the performer, and shows the performer itself there.
  plate.known.assign(size_t(kSide * kSide), 1);
  cv::Mat box = cv::Mat::zeros(kSide, kSide, CV_8U);
  box(cv::Rect(40, 30, 80, 90)) = 255;
  ASSERT_EQ(cv::countNonZero(truth & ~box), 0);
  for (int i = 0; i < kSide * kSide; ++i)
    if (box.at<uint8_t>(i)) {
      plate.known[size_t(i)] = 0;
      for (size_t c = 0; c < 3; ++c) plate.mean[3 * size_t(i) + c] = picture.pixels[3 * size_t(i) + c];
    }
  KeyCut key(picture, plate);
  ColourCounts colours;
  key.count(truth, colours);
  key.use(colours);
  EXPECT_GT(unionShare(key.cut(), truth), 0.95);
}

}  // namespace
}  // namespace fourdvt::mattes

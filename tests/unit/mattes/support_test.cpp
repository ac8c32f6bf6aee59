// SPDX-License-Identifier: Apache-2.0
// Support of masks by other cameras, and contradicting silhouettes, on balls with exact masks.
#include "mattes/support.h"

#include <gtest/gtest.h>

#include "mattes_fixture.h"

namespace fourdvt::mattes {
namespace {

const Ball kPerformer{{0, 0, 0}, 0.45, {}, 0};
constexpr double kFloor_m = -0.5;

std::vector<cv::Mat> masksOf(const std::vector<capture::CaptureCamera>& rig, const std::vector<Ball>& balls) {
  std::vector<cv::Mat> out;
  for (const auto& c : rig) out.push_back(maskOf(c, balls));
  return out;
}

// The support at the pixel that shows a point of the world.
int missedAt(const SupportFinder& finder, const std::vector<Support>& support, size_t camera,
             const capture::CaptureCamera& calibrated, const glm::dvec3& point) {
  const glm::dvec3 p = calibrated.pinhole.project(point);
  return finder.fullSize(support[camera].missed, camera).at<int16_t>(int(p.y), int(p.x));
}

TEST(MattesSupport, SaysWhatOtherCamerasSee) {
  const auto rig = ringOf(6);
  const SupportFinder finder(rig, kFloor_m);
  std::vector<cv::Mat> masks = masksOf(rig, {kPerformer});
  // A ball that is in camera 0's mask only, beside the performer.
  const Ball stranger{{1.2, 0, 0.2}, 0.2, {}, 0};
  masks[0] |= maskOf(rig[0], {stranger});
  const auto support = finder.find(masks, 1);
  for (size_t i = 0; i < rig.size(); ++i) EXPECT_EQ(missedAt(finder, support, i, rig[i], {0, 0, 0}), 0) << i;
  EXPECT_GE(missedAt(finder, support, 0, rig[0], stranger.centre), 1);
  // Highest supported position in the middle of the performer, whose top is 0.45 m above its centre, 0.95 above ground;
  // hulls of six cameras are slightly larger.
  const glm::dvec3 p = rig[2].pinhole.project({0, 0, 0});
  const float height = finder.fullSize(support[2].height_m, 2).at<float>(int(p.y), int(p.x));
  EXPECT_GT(height, 0.5);
  EXPECT_LT(height, 1.05);
}

TEST(MattesSupport, FindsWhatLiesOnTheFloor) {
  const auto rig = ringOf(6);
  const SupportFinder finder(rig, kFloor_m);
  // A flat patch: masks of a ball flattened onto the floor.
  std::vector<cv::Mat> masks;
  for (const auto& c : rig) {
    cv::Mat mask(kSide, kSide, CV_8U, cv::Scalar(0));
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const glm::dvec3 from = c.pinhole.centreInWorld(), along = rayOf(c.pinhole, x + 0.5, y + 0.5);
        if (along.y >= 0) continue;
        const glm::dvec3 on = from + along * ((kFloor_m - from.y) / along.y);
        if (std::hypot(on.x, on.z) < 0.4) mask.at<uint8_t>(y, x) = 255;
      }
    masks.push_back(mask);
  }
  const auto support = finder.find(masks, 1);
  const glm::dvec3 p = rig[1].pinhole.project({0, kFloor_m, 0});
  EXPECT_EQ(missedAt(finder, support, 1, rig[1], {0, kFloor_m, 0}), 0);
  EXPECT_LT(finder.fullSize(support[1].height_m, 1).at<float>(int(p.y), int(p.x)), 0.12);
}

TEST(MattesSupport, ReachesWhereTheOwnMaskHasAHole) {
  const auto rig = ringOf(6);
  std::vector<cv::Mat> masks = masksOf(rig, {kPerformer});
  masks[3] = cv::Mat::zeros(kSide, kSide, CV_8U);
  masks[3].at<uint8_t>(5, 5) = 255;  // far from the performer
  const SupportFinder finder(rig, kFloor_m);
  const auto support = finder.find(masks, 1);
  EXPECT_EQ(missedAt(finder, support, 3, rig[3], {0, 0, 0}), 0);
  // A camera with an empty mask is ignored.
  masks[3] = cv::Mat::zeros(kSide, kSide, CV_8U);
  const auto without = finder.find(masks, 1);
  EXPECT_EQ(missedAt(finder, without, 0, rig[0], {0, 0, 0}), 0);
}

TEST(MattesSupport, SeesThroughLenses) {
  auto rig = ringOf(5);
  for (size_t i = 0; i < rig.size(); ++i) rig[i].distortion.k1 = i % 2 ? -0.6 : 0.5;
  const Ball performer{{0.75, 0.1, 0}, 0.3, {}, 0};  // where lenses matter
  // Masks with distortion: a filmed pixel shows the pinhole's content at pinholePixel.
  std::vector<cv::Mat> masks;
  for (const auto& c : rig) {
    cv::Mat mask(kSide, kSide, CV_8U, cv::Scalar(0));
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const glm::dvec2 p = capture::pinholePixel(c, {x + 0.5, y + 0.5});
        if (hitOf(performer, c.pinhole.centreInWorld(), rayOf(c.pinhole, p.x, p.y)) > 0) mask.at<uint8_t>(y, x) = 255;
      }
    masks.push_back(mask);
  }
  const auto explained = SupportFinder(rig, kFloor_m).explain(masks, 1);
  for (const double share : explained.share) EXPECT_GT(share, 0.99);
  for (auto& c : rig) c.distortion = {};
  const auto ignored = SupportFinder(rig, kFloor_m).explain(masks, 1);
  double mean = 0;
  for (const double share : ignored.share) mean += share / double(rig.size());
  EXPECT_LT(mean, 0.99);
}

TEST(MattesSupport, GuessesWhereAllCamerasLook) {
  auto rig = ringOf(4);
  const SupportFinder finder(rig, kFloor_m);
  const cv::Mat seen = finder.fullSize(finder.seenByAll()[0], 0);
  const glm::dvec3 middle = rig[0].pinhole.project({0, 0, 0});
  EXPECT_EQ(seen.at<uint8_t>(int(middle.y), int(middle.x)), 255);
  // A camera that faces away from all others: no space is visible to all.
  rig[3].pinhole = testing::lookAt({0, 1.2, 3}, {0, 1.2, 9}, kSide, kSide, 190);
  EXPECT_EQ(cv::countNonZero(SupportFinder(rig, kFloor_m).seenByAll()[0]), 0);
}

TEST(MattesAgreement, NamesTheCameraThatDoesNotFit) {
  const auto rig = ringOf(6);
  std::vector<cv::Mat> masks = masksOf(rig, {kPerformer});
  EXPECT_FALSE(disagreement(rig, masks).has_value());
  cv::Mat moved = cv::Mat::zeros(kSide, kSide, CV_8U);  // 40 pixels to the side
  masks[4](cv::Rect(0, 0, kSide - 40, kSide)).copyTo(moved(cv::Rect(40, 0, kSide - 40, kSide)));
  masks[4] = moved;
  const auto why = disagreement(rig, masks);
  ASSERT_TRUE(why.has_value());
  EXPECT_NE(why->find("\"cam04\""), std::string::npos) << *why;
  EXPECT_NE(why->find("100 % without it"), std::string::npos) << *why;
}

TEST(MattesAgreement, NamesTheCameraWhoseMaskIsTheWholePicture) {
  const auto rig = ringOf(6);
  std::vector<cv::Mat> masks = masksOf(rig, {kPerformer});
  masks[2] = cv::Mat(kSide, kSide, CV_8U, cv::Scalar(255));  // contradicts no other mask
  const auto why = disagreement(rig, masks);
  ASSERT_TRUE(why.has_value());
  EXPECT_NE(why->find("\"cam02\""), std::string::npos) << *why;
  EXPECT_NE(why->find("of it lie in a common volume with theirs"), std::string::npos) << *why;
}

TEST(MattesAgreement, ToleratesStrangersAndEmptyCameras) {
  const auto rig = ringOf(6);
  std::vector<cv::Mat> masks = masksOf(rig, {kPerformer});
  masks[0] |= maskOf(rig[0], {{{1.1, 0.2, 0.2}, 0.3, {}, 0}});
  masks[1] = cv::Mat::zeros(kSide, kSide, CV_8U);
  EXPECT_FALSE(disagreement(rig, masks).has_value());
  // With two cameras it is undecidable which one is wrong.
  for (size_t i = 2; i < masks.size(); ++i) masks[i] = cv::Mat::zeros(kSide, kSide, CV_8U);
  masks[1] = maskOf(rig[1], {{{1, 0, 1}, 0.2, {}, 0}});
  EXPECT_FALSE(disagreement(rig, masks).has_value());
}

TEST(MattesAgreement, SaysSoWhereNoTwoAgree) {
  const auto rig = ringOf(5);
  std::vector<cv::Mat> masks;
  for (size_t i = 0; i < rig.size(); ++i)
    masks.push_back(maskOf(
        rig[i],
        {{{0.7 * std::sin(2.5 * double(i)), 0.3 * double(i) - 0.6, 0.7 * std::cos(2.5 * double(i))}, 0.15, {}, 0}}));
  const auto why = disagreement(rig, masks);
  ASSERT_TRUE(why.has_value());
  EXPECT_NE(why->find("no common volume"), std::string::npos) << *why;
}

}  // namespace
}  // namespace fourdvt::mattes

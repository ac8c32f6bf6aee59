// SPDX-License-Identifier: Apache-2.0
// Time offsets and poses of cameras, from silhouettes of balls.
#include <gtest/gtest.h>

#include "base/robust.h"
#include "rig_fixture.h"

namespace fourdvt::refine {
namespace {

constexpr double kRadians = 3.14159265358979323846 / 180;
const std::vector<double> kInStep(8, 0.0);

std::vector<CameraRefit> fitted(const SilhouetteClip& clip, const std::vector<PinholeCamera>& given) {
  return fitRig({{&clip, kInStep}}, given, {}, [] { return true; });
}

// Every second picture of synchronous cameras; created once for all tests.
const std::vector<std::vector<Image>>& picturesInStep() {
  static const auto all = [] {
    const auto cameras = ringOfCameras();
    std::vector<std::vector<Image>> out(kRigFrames / 2);
    for (int k = 0; k < kRigFrames / 2; ++k)
      for (const PinholeCamera& camera : cameras) out[size_t(k)].push_back(silhouetteOf(camera, 2 * k));
    return out;
  }();
  return all;
}

const SilhouetteClip& clipInStep() {
  static const SilhouetteClip clip = [] {
    SilhouetteClip out(ringOfCameras(), false);
    for (const std::vector<Image>& pictures : picturesInStep()) out.add(pictures);
    return out;
  }();
  return clip;
}

TEST(Rig, HullOfTheOthersHoldsTheSilhouetteAndTouchesIt) {
  const auto cameras = ringOfCameras();
  const SilhouetteClip& clip = clipInStep();
  std::vector<double> residuals;
  for (size_t c = 0; c < cameras.size(); ++c)
    for (const BlockedPoint& p : hullPoints(clip, {cameras, kInStep, {}}, c, {2, 6}, 60, 0, 12))
      residuals.push_back(p.point.residual_pixels);
  ASSERT_GT(residuals.size(), 400u);
  EXPECT_LT(quantile(residuals, 0.98), 0.3);   // no silhouette sticks out
  EXPECT_GT(quantile(residuals, 0.75), -0.5);  // most of the outline touches the hull
  for (const StickOut& s : stickOut({{&clip, kInStep}}, cameras, {})) EXPECT_LT(s.mean_pixels, 0.05);
}

TEST(Rig, TimesAreFoundToATenthOfAFrame) {
  const std::vector<double> truth{0, 1.3, -2.4, 0.5, 3.4, -0.7, 2.2, -3.4};
  const auto cameras = ringOfCameras();
  const auto times = fitTimes(filmed(cameras, truth), {cameras, kInStep, {}}, {});
  std::vector<double> shift, offsets;
  for (size_t c = 0; c < truth.size(); ++c) {
    offsets.push_back(times[c].offset_frames);
    EXPECT_TRUE(times[c].known) << c;
    EXPECT_LT(times[c].deviation_frames, 0.05) << c;
    shift.push_back(times[c].offset_frames - truth[c]);
  }
  const double common = quantile(shift, 0.5);  // the common offset is undetermined
  for (size_t c = 0; c < truth.size(); ++c) EXPECT_NEAR(shift[c], common, 0.1) << c;
  EXPECT_NEAR(quantile(offsets, 0.5), 0, 1e-9);
}

TEST(Rig, CamerasOnTimeStayOnTime) {
  const auto cameras = ringOfCameras();
  for (const CameraTime& time : fitTimes(clipInStep(), {cameras, kInStep, {}}, {}))
    EXPECT_NEAR(time.offset_frames, 0, 0.02);
}

TEST(Rig, NothingIsKnownOfTimeWhereNothingMoves) {
  const auto cameras = ringOfCameras();
  SilhouetteClip clip(cameras, false);
  std::vector<Image> pictures;
  for (const PinholeCamera& camera : cameras) pictures.push_back(silhouetteOf(camera, 4));
  for (int k = 0; k < 12; ++k) clip.add(pictures);
  for (const CameraTime& time : fitTimes(clip, {cameras, kInStep, {}}, {})) EXPECT_FALSE(time.known);
}

TEST(Rig, TurnedCamerasAreTurnedBackAndTheOthersStay) {
  const auto truth = ringOfCameras();
  auto given = truth;
  given[2] = changed(truth[2], {.turn_rad = {0.3 * kRadians, -0.4 * kRadians, 0}});
  given[5] = changed(truth[5], {.turn_rad = {-0.2 * kRadians, 0.35 * kRadians, 0.3 * kRadians}});
  const auto found = fitted(clipInStep(), given);
  for (size_t c = 0; c < truth.size(); ++c) {
    const bool turned = c == 2 || c == 5;
    EXPECT_EQ(found[c].changed, turned) << c;
    EXPECT_LT(degreesApart(found[c].camera, truth[c]), turned ? 0.1 : 0.02) << c;
  }
}

TEST(Rig, OfRigsThatFitAlikeTheOneThatTurnsFewestIsKept) {
  const auto given = ringOfCameras();
  // All cameras miss the performer by 5 mm, and one is rotated as well.
  const glm::dvec3 at(0.003, 0.002, -0.0035);
  auto found = given;
  for (PinholeCamera& camera : found) {
    const glm::dvec3 p(camera.cam_from_world[3]), q = p + glm::dmat3(camera.cam_from_world) * at;
    camera = changed(camera, {.turn_rad = glm::cross(glm::normalize(p), glm::normalize(q))});
  }
  found[6] = changed(found[6], {.turn_rad = {0.4 * kRadians, 0, 0}});
  const auto fewer = minTurned(given, found, {0, 0, 0}, std::vector<double>(8, 0.01));
  for (size_t c = 0; c < given.size(); ++c) {
    if (c == 6)
      EXPECT_NEAR(degreesApart(fewer[c], given[c]), 0.4, 0.01);
    else
      EXPECT_EQ(fewer[c].cam_from_world, given[c].cam_from_world) << c;
  }
}

TEST(Rig, RightCamerasStayEvenIfAllMattesAreTooLarge) {
  const auto truth = ringOfCameras();
  SilhouetteClip clip(truth, false);
  for (const std::vector<Image>& in_step : picturesInStep()) {
    std::vector<Image> pictures;
    for (const Image& picture : in_step) {
      Image grown = picture;  // by a pixel
      for (int y = 1; y + 1 < picture.height; ++y)
        for (int x = 1; x + 1 < picture.width; ++x)
          for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}})
            *grown.at(x, y) = std::max(*grown.at(x, y), *picture.at(x + dx, y + dy));
      pictures.push_back(grown);
    }
    clip.add(pictures);
  }
  for (const CameraRefit& refit : fitted(clip, truth)) EXPECT_FALSE(refit.changed);
}

TEST(Rig, IgnoredCameraNeitherCountsNorChanges) {
  const auto truth = ringOfCameras();
  auto given = truth;
  given[3] = changed(truth[3], {.turn_rad = {0, 6 * kRadians, 0}});
  const SilhouetteClip& clip = clipInStep();
  const std::vector<TimedClip> clips{{&clip, kInStep}};
  std::vector<char> ignored(8, 0);
  EXPECT_GT(stickOut(clips, given, ignored)[0].far_share, 0.1);
  ignored[3] = 1;
  const auto without = stickOut(clips, given, ignored);
  for (size_t c = 0; c < truth.size(); ++c) {
    if (c != 3) {
      EXPECT_LT(without[c].far_share, 0.01) << c;
    }
  }
  EXPECT_GT(without[3].far_share, 0.3);
  const auto found = fitRig(clips, given, ignored, [] { return true; });
  for (const CameraRefit& refit : found) EXPECT_FALSE(refit.changed);
}

}  // namespace
}  // namespace fourdvt::refine

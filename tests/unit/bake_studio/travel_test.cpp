// SPDX-License-Identifier: Apache-2.0
// Root motion of a walk through the room against that of the same stride on the spot.
#include <gtest/gtest.h>

#include "bake/motion/root_track.h"
#include "capture/capture.h"
#include "lab/studio/actors/actor.h"
#include "lab/studio/tracker.h"

namespace fourdvt::bake {
namespace {

constexpr uint32_t kStride = 28, kFirst = 9;  // frames; the first one of the loop
constexpr double kStrides = 2;

TEST(StudioTravel, FeetStandWhereTheyStoodInTheRoom) {
  const auto actor = studio::withStrides(studio::createProceduralActor({"walk"}, 0.03).take(), kStrides, true);
  const auto one = studio::createProceduralActor({"walk"}, 0.03).take();
  const studio::Tracker tracker(*actor, studio::StudioKnobs());
  const double way_m = glm::length(one->motions()[0].root_velocity_mps) * one->motions()[0].duration_s;
  const auto inRoom = [&](uint32_t frame) {
    const double phase = (kFirst + frame) / (kStrides * kStride);
    Positions surface;
    actor->pose(std::vector<double>{1}, phase, surface);
    return tracker.truth(tracker.points(0, phase), surface);
  };
  capture::Capture room;
  room.fps = kStride / one->motions()[0].duration_s;
  capture::CaptureSequence walk;
  walk.frame_count = kStride;
  walk.loop = true;
  walk.travel = capture::CaptureTravel{{0, {0, way_m}}, {}};
  const ReadPositions read = [&](const capture::CaptureSequence& sequence, uint32_t frame) -> Result<Positions> {
    Positions out = inRoom(frame);
    capture::putInPlace(sequence, frame, out);
    return out;
  };
  const auto track = rootTrack(room, walk, read, nullptr);
  ASSERT_TRUE(track.ok());
  EXPECT_NEAR(track.value().back().y, way_m, 0.01 * way_m);
  EXPECT_NEAR(track.value().back().x, 0, 0.01 * way_m);
  const auto skate = footSkate(room, walk, track.value(), read);
  ASSERT_TRUE(skate.ok());
  EXPECT_GT(skate.value().contacts, 10);
  EXPECT_LT(skate.value().mean_m, 0.01);
  // Played with its root motion, each frame lies where it was filmed, but for a common shift.
  const glm::vec3 shift = read(walk, 0).value()[0] - inRoom(0)[0];
  for (uint32_t f = 0; f < kStride; ++f) {
    const glm::vec3 root = track.value()[f], played = read(walk, f).value()[0] + glm::vec3(root.x, 0, root.y);
    EXPECT_LT(glm::distance(played - inRoom(f)[0], shift), 0.015) << f;
  }
}

}  // namespace
}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Motion classes, parameters and root motion against the simulated edge.
#include <cmath>

#include "player_edge.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

constexpr double kWalk_s = 1.4, kRun_s = 0.7;

// 28 phases at the mean duration's rate; a pass of the walk travels 1.75 m, of the run 1.89 m.
FakeCharacter locomotion() {
  const FakeMember walk{1.25, kWalk_s, {0, 1.75, 0}}, run{2.7, kRun_s, {0, 1.89, 0}};
  return FakeBuilder().build({{"locomotion", 28, 10, 28 / 1.05, true, 192, 16, {walk, run}},
                              {"pickup", 23, 9, 30, false, 128, 32, {{0, 23.0 / 30, {}}}}});
}

struct Playing {
  explicit Playing(const FakeCharacter& character, const EdgeOptions& options = {}) : edge(character, options) {
    EXPECT_TRUE(edge.player->loadManifest(character.manifest).ok());
    EXPECT_TRUE(edge.runUntilShown());
  }
  // Frames shown in `seconds`, after a second in which caches fill.
  int framesIn(double seconds) {
    edge.runUntil([] { return false; }, 1);
    int frames = 0;
    uint32_t last = edge.player->frame();
    for (const double end_s = edge.now_s + seconds; edge.now_s < end_s;) {
      edge.step(0.004);
      frames += int((edge.player->frame() + 28 - last) % 28);
      last = edge.player->frame();
      edge.expectPaired();
    }
    return frames;
  }
  SimulatedEdge edge;
};

}  // namespace

TEST(PlayerClass, TakesTheTimeThatItsWeightsSay) {
  for (double run_share : {0.0, 0.25, 0.5, 1.0}) {
    Playing p(locomotion());
    ASSERT_TRUE(p.edge.player->setParameter("speed_mps", 1.25 + run_share * 1.45, true).ok());
    p.edge.player->play();
    const double pass_s = kWalk_s + run_share * (kRun_s - kWalk_s);
    EXPECT_NEAR(p.framesIn(10) / (28 * 10 / pass_s), 1, 0.02) << run_share;
    EXPECT_NEAR(p.edge.draw().member, run_share, 1e-3);
  }
}

TEST(PlayerClass, StartsAsItsFirstMemberAndClampsTheParameter) {
  Playing p(locomotion());
  EXPECT_NEAR(p.edge.player->parameter("speed_mps"), 1.25, 1e-12);
  EXPECT_NEAR(p.edge.draw().member, 0, 1e-3);
  ASSERT_TRUE(p.edge.player->setParameter("speed_mps", 99, true).ok());
  EXPECT_NEAR(p.edge.player->parameter("speed_mps"), 2.7, 1e-12);
  EXPECT_EQ(p.edge.player->setParameter("height_m", 1, false).error().id, ErrorId::InvalidArgument);
  EXPECT_EQ(p.edge.player->setParameter("speed_mps", std::nan(""), false).error().id, ErrorId::InvalidArgument);
  EXPECT_TRUE(std::isnan(p.edge.player->parameter("height_m")));
}

TEST(PlayerClass, AParameterSetBeforeTheManifestIsKept) {
  const FakeCharacter character = locomotion();
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.player->setParameter("speed_mps", 2.7, false).ok());
  ASSERT_TRUE(edge.load());
  EXPECT_NEAR(edge.draw().member, 1, 1e-3);
}

// A paused character follows the slider: same picture, another mesh.
TEST(PlayerClass, GlidesWhilePausedAtTheParametersRate) {
  const double rate = 0.5;  // whole ranges a second
  EdgeOptions options;
  options.player.parameter_rate = rate;
  Playing p(locomotion(), options);
  const uint64_t shown = p.edge.player->stats().frames_shown;
  ASSERT_TRUE(p.edge.player->setParameter("speed_mps", 2.7, false).ok());
  double last = p.edge.draw().member;
  const double start_s = p.edge.now_s;
  while (p.edge.player->parameter("speed_mps") < 2.7 && p.edge.now_s < start_s + 10) {
    p.edge.step(0.02);
    const double now = p.edge.draw().member;
    EXPECT_LE(now - last, rate * 0.02 + 2e-3);
    EXPECT_GE(now, last - 1e-6);
    last = now;
  }
  EXPECT_NEAR(p.edge.now_s - start_s, 1 / rate, 0.05);
  EXPECT_NEAR(last, 1, 1e-3);
  EXPECT_EQ(p.edge.player->stats().frames_shown, shown);
  EXPECT_EQ(p.edge.player->frame(), 0u);
}

// Travel equals speed × time, however many frames are skipped and loops wrap.
TEST(PlayerTravel, CoversTheGroundOfItsPasses) {
  for (double step_s : {0.004, 0.03, 0.11}) {
    for (double run_share : {0.0, 0.5, 1.0}) {
      Playing p(locomotion());
      ASSERT_TRUE(p.edge.player->setParameter("speed_mps", 1.25 + run_share * 1.45, true).ok());
      p.edge.player->setTravel(true);
      p.edge.player->play();
      double passes = 0;
      uint32_t last = p.edge.player->frame();
      for (int i = 0; i < int(6 / step_s); ++i) {
        p.edge.step(step_s);
        passes += int((p.edge.player->frame() + 28 - last) % 28) / 28.0;
        last = p.edge.player->frame();
      }
      ASSERT_GT(passes, 1.5);
      const motion::Placement at = p.edge.player->placement();
      EXPECT_NEAR(at.ground_m.y, passes * (1.75 + run_share * 0.14), 0.01) << step_s << " " << run_share;
      EXPECT_NEAR(at.ground_m.x, 0, 1e-4);
    }
  }
}

TEST(PlayerTravel, MovesOnlyWithNewFramesAndOnlyWhenAskedTo) {
  Playing p(locomotion());
  p.edge.player->play();
  p.edge.runUntil([] { return false; }, 2);
  EXPECT_EQ(p.edge.player->placement().ground_m, glm::vec2(0)) << "off by default";
  p.edge.player->setTravel(true);
  for (int i = 0; i < 500; ++i) {
    const uint32_t frame = p.edge.player->frame();
    const glm::vec2 before = p.edge.player->placement().ground_m;
    p.edge.step(0.005);
    if (p.edge.player->frame() == frame) {
      EXPECT_EQ(p.edge.player->placement().ground_m, before);
    }
  }
  p.edge.player->seekFrame(3);
  const glm::vec2 before = p.edge.player->placement().ground_m;
  p.edge.player->pause();
  ASSERT_TRUE(p.edge.runUntilShown());
  EXPECT_EQ(p.edge.player->placement().ground_m, before) << "a seek is no way";
}

TEST(PlayerTravel, APassThatTurnsWalksACircle) {
  const FakeMember turning{0, 1, {0, 0, 1.5707963}};  // on the spot, a quarter turn per pass
  FakeCharacter character = FakeBuilder().build({{"turn", 28, 10, 28, true, 192, 16, {turning}}});
  Playing p(character);
  p.edge.player->setTravel(true);
  p.edge.player->play();
  ASSERT_TRUE(p.edge.runUntil([&] { return p.edge.player->stats().frames_shown >= 1 + 4 * 28; }));
  EXPECT_NEAR(motion::wrapAngle(p.edge.player->placement().heading_rad), 0, 1e-3);
}

TEST(PlayerTravel, SteersAtTheTurnRateAndWalksThere) {
  Playing p(locomotion());
  p.edge.player->setTravel(true);
  p.edge.player->setPlacement({{5, -2}, 3.0f});
  p.edge.player->steer(-3.0);  // the shorter way, across ±π
  p.edge.step(0.01);
  EXPECT_FLOAT_EQ(p.edge.player->placement().heading_rad, 3.0f) << "paused";
  p.edge.player->play();
  p.edge.step(0.05);
  EXPECT_NEAR(p.edge.player->placement().heading_rad, 3 + 0.05 * 2.1, 1e-4);
  p.edge.runUntil([] { return false; }, 1);
  EXPECT_NEAR(p.edge.player->placement().heading_rad, -3, 1e-5);
  const glm::vec2 from = p.edge.player->placement().ground_m;
  p.edge.runUntil([] { return false; }, 2);
  const glm::vec2 way = p.edge.player->placement().ground_m - from;
  EXPECT_NEAR(std::atan2(way.x, way.y), -3, 1e-3) << "heading turns from +z towards +x";
  EXPECT_NEAR(glm::length(way), 2 * 1.25, 0.15);
  const glm::mat4 world = p.edge.player->figure().value().world_from_character;
  EXPECT_EQ(glm::vec2(world[3].x, world[3].z), p.edge.player->placement().ground_m);
}

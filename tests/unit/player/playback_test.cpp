// SPDX-License-Identifier: Apache-2.0
// Playback in isolation: events of a media element on playing, seeking and starving.
#include "player/parts/playback.h"

#include <gtest/gtest.h>

using namespace fourdvt;

namespace {

struct Playing {
  std::vector<EventKind> events() {
    std::vector<EventKind> kinds;
    for (Event event; outbox.nextEvent(event);) kinds.push_back(event.kind);
    return kinds;
  }
  Outbox outbox;
  Playback playback{outbox};
};

using Kinds = std::vector<EventKind>;

}  // namespace

TEST(PlayerPlayback, PlayAndPauseOnce) {
  Playing p;
  EXPECT_FALSE(p.playback.pause()) << "it starts paused";
  EXPECT_TRUE(p.playback.play());
  EXPECT_FALSE(p.playback.play());
  EXPECT_TRUE(p.playback.pause());
  EXPECT_FALSE(p.playback.playing());
  EXPECT_EQ(p.events(), Kinds{EventKind::Paused});
  p.playback.play();
  p.playback.end();
  EXPECT_FALSE(p.playback.playing());
  EXPECT_EQ(p.events(), (Kinds{EventKind::TimeUpdate, EventKind::Paused, EventKind::Ended}));
}

TEST(PlayerPlayback, ASeekEndsWithTheEventsThatApply) {
  Playing p;
  p.playback.finishSeek(false);
  EXPECT_EQ(p.events(), Kinds{EventKind::CanPlay});
  p.playback.requestSeek();
  p.playback.play();
  p.playback.finishSeek(true);
  EXPECT_EQ(p.events(), (Kinds{EventKind::SequenceChanged, EventKind::Seeked, EventKind::Playing}));
  p.playback.finishSeek(false);
  EXPECT_EQ(p.events(), Kinds{EventKind::Playing}) << "each only once";
}

TEST(PlayerPlayback, WaitingComesAfterAWhileAndPlayingAfterIt) {
  Playing p;
  p.playback.play();
  p.playback.tick(1);
  p.playback.noteStarvation(true);
  p.playback.tick(1.2);
  p.playback.noteStarvation(true);
  EXPECT_EQ(p.events(), Kinds{}) << "too short to tell";
  p.playback.tick(1.3);
  p.playback.noteStarvation(true);
  p.playback.tick(1.4);
  p.playback.noteStarvation(true);
  EXPECT_EQ(p.events(), Kinds{EventKind::Waiting});
  p.playback.noteStarvation(false);
  p.playback.noteStarvation(false);
  EXPECT_EQ(p.events(), Kinds{EventKind::Playing});
  p.playback.noteStarvation(true);
  p.playback.forgetStarvation();
  p.playback.tick(2);
  p.playback.noteStarvation(true);
  EXPECT_EQ(p.events(), Kinds{}) << "counted from the start";
}

TEST(PlayerPlayback, TimeUpdatesFourTimesASecondWhilePlaying) {
  Playing p;
  int updates = 0;
  for (int tick = 0; tick <= 100; ++tick) {
    if (tick == 50) p.playback.play();
    p.playback.tick(10 + tick / 50.0);
    p.playback.finishTick(tick % 2 == 1);
    updates += int(p.events().size());
  }
  EXPECT_EQ(updates, 4);
}

TEST(PlayerPlayback, ASleepingTabCountsAsAShortStep) {
  Playing p;
  p.playback.tick(100);
  EXPECT_EQ(p.playback.tick_s(), 0) << "the first";
  p.playback.tick(100.1);
  EXPECT_NEAR(p.playback.tick_s(), 0.1, 1e-9);
  p.playback.tick(900);
  EXPECT_EQ(p.playback.tick_s(), kMaxStep_s);
  p.playback.tick(800);
  EXPECT_EQ(p.playback.tick_s(), 0);
}

TEST(PlayerPlayback, RateAndLoopStayInRange) {
  Playing p;
  p.playback.setRate(9);
  EXPECT_EQ(p.playback.rate(), 4);
  p.playback.play();
  p.playback.setRate(0);
  EXPECT_TRUE(p.playback.playing());
  EXPECT_FALSE(p.playback.running());
  p.playback.setRate(-1);
  EXPECT_EQ(p.playback.rate(), 4);
  EXPECT_TRUE(p.playback.running());
  package::Sequence sequence;
  for (bool loop : {false, true}) {
    sequence.loop = loop;
    p.playback.setLoop(-7);
    EXPECT_EQ(p.playback.loops(sequence), loop);
    p.playback.setLoop(0);
    EXPECT_FALSE(p.playback.loops(sequence));
    p.playback.setLoop(3);
    EXPECT_TRUE(p.playback.loops(sequence));
  }
}

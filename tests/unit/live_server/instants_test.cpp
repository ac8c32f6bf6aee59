// SPDX-License-Identifier: Apache-2.0
#include "live/server/instants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace fourdvt::live {
namespace {

constexpr size_t kCameras = 4;
constexpr int64_t kPeriod_us = 40'000, kBegin_us = 45'000'000 * kPeriod_us;

std::shared_ptr<const TimedPicture> pictureAt(int64_t captured_us) {
  auto out = std::make_shared<TimedPicture>();
  out->captured_us = captured_us;
  return out;
}

class InstantsTest : public ::testing::Test {
 protected:
  InstantsTest() {
    for (size_t c = 0; c < kCameras; ++c) instants.setConnected(c, true, kBegin_us);
  }
  static int64_t timeOf(int frame, int64_t phase_us = 0) { return kBegin_us + frame * kPeriod_us + phase_us; }
  // Sends a picture 20 ms after its capture.
  bool send(size_t camera, int frame, int64_t phase_us = 0) {
    return instants.add(camera, pictureAt(timeOf(frame, phase_us)), timeOf(frame, phase_us + 20'000));
  }

  Instants instants{{kCameras, 25, 0.1, 0.5}};
};

TEST_F(InstantsTest, IsMadeAsSoonAsAllAreThere) {
  const int64_t phases_us[] = {-15'000, 0, 7'000, 16'000};
  for (int f = 0; f < 50; ++f) {
    for (size_t c = 0; c < kCameras; ++c) {
      EXPECT_FALSE(instants.take(timeOf(f, 39'000)));
      EXPECT_TRUE(send(c, f, phases_us[c]));
    }
    const auto taken = instants.take(timeOf(f, 39'000));
    ASSERT_TRUE(taken);
    EXPECT_TRUE(taken->instant.complete);
    EXPECT_EQ(taken->instant.count(), kCameras);
    EXPECT_EQ(taken->instant.slot, kBegin_us / kPeriod_us + f);
    EXPECT_EQ(taken->instant.captured_us, timeOf(f, 2000)) << "the mean";
    EXPECT_TRUE(taken->skipped.empty());
    EXPECT_EQ(instants.held(), 0u);
  }
  EXPECT_EQ(instants.skipped(), 0u);
}

// Near a slot's border jitter could move a picture into the neighbouring slot.
TEST_F(InstantsTest, ACameraHalfAFrameApartKeepsItsSlots) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int64_t> jitter_us(-3000, 3000);
  int complete = 0;
  for (int f = 0; f < 100; ++f) {
    for (size_t c = 0; c < kCameras; ++c) send(c, f, (c == 2 ? 19'900 : 0) + jitter_us(random));
    const auto taken = instants.take(timeOf(f, 45'000));
    complete += taken && taken->instant.complete;
  }
  EXPECT_GE(complete, 98);
  for (size_t c = 0; c < kCameras; ++c) EXPECT_EQ(instants.late(c), 0u);
}

TEST_F(InstantsTest, IsMadeWithoutALatePictureAndCountsIt) {
  for (size_t c = 0; c + 1 < kCameras; ++c) send(c, 0);
  EXPECT_EQ(instants.due_us(), timeOf(0, 100'000));
  EXPECT_FALSE(instants.take(timeOf(0, 99'999)));
  const auto taken = instants.take(timeOf(0, 100'001));
  ASSERT_TRUE(taken);
  EXPECT_FALSE(taken->instant.complete);
  EXPECT_EQ(taken->instant.count(), kCameras - 1);
  EXPECT_FALSE(instants.add(kCameras - 1, pictureAt(timeOf(0)), timeOf(0, 110'000)));
  EXPECT_EQ(instants.late(kCameras - 1), 1u);
}

TEST_F(InstantsTest, NeedsTwoPictures) {
  send(0, 0);
  EXPECT_FALSE(instants.take(timeOf(0, 200'000)));
  EXPECT_EQ(instants.tooFew(), 1u);
  EXPECT_EQ(instants.held(), 0u);
}

TEST_F(InstantsTest, ALostCameraIsNotWaitedForAndComesBack) {
  const auto complete = [&](int f, size_t cameras) {
    for (size_t c = 0; c < cameras; ++c) send(c, f);
    const auto taken = instants.take(timeOf(f, 30'000));
    return taken && taken->instant.complete;
  };
  EXPECT_TRUE(complete(0, kCameras));
  EXPECT_FALSE(complete(1, kCameras - 1));
  for (int f = 2; f < 13; ++f) complete(f, kCameras - 1);
  EXPECT_TRUE(instants.lost(kCameras - 1, timeOf(13, 30'000)));
  for (int f = 13; f < 20; ++f) EXPECT_TRUE(complete(f, kCameras - 1)) << f;
  EXPECT_TRUE(complete(20, kCameras));
  EXPECT_FALSE(instants.lost(kCameras - 1, timeOf(20, 30'000)));
  EXPECT_FALSE(complete(21, kCameras - 1)) << "waited for again";
}

TEST_F(InstantsTest, ACameraThatGoesIsNotWaitedFor) {
  for (size_t c = 0; c + 1 < kCameras; ++c) send(c, 0);
  EXPECT_FALSE(instants.take(timeOf(0, 30'000)));
  instants.setConnected(kCameras - 1, false, timeOf(0, 30'000));
  const auto taken = instants.take(timeOf(0, 30'000));
  ASSERT_TRUE(taken);
  EXPECT_TRUE(taken->instant.complete);
}

// Its pictures would always be late: after some of them, instants are made without waiting for it.
TEST_F(InstantsTest, ACamera200msLateDoesNotHoldUpTheOthers) {
  std::vector<int64_t> made_us;  // after the capture
  int f = 0;
  for (int64_t now_us = timeOf(0); now_us < timeOf(60); now_us += 1000) {
    if ((now_us - timeOf(0)) % kPeriod_us == 20'000) {
      for (size_t c = 0; c + 1 < kCameras; ++c) instants.add(c, pictureAt(now_us - 20'000), now_us);
      if (f >= 5) instants.add(kCameras - 1, pictureAt(now_us - 200'000 - 20'000), now_us);
      ++f;
    }
    if (const auto taken = instants.take(now_us)) made_us.push_back(now_us - taken->instant.captured_us);
  }
  ASSERT_GT(made_us.size(), 50u);
  EXPECT_EQ(made_us.back(), 20'000);
  EXPECT_GT(instants.late(kCameras - 1), 40u);
  // Its delay ends: its pictures are used again.
  for (int frame = 60; frame < 64; ++frame) {
    for (size_t c = 0; c < kCameras; ++c) send(kCameras - 1 - c, frame);
    const auto taken = instants.take(timeOf(frame, 30'000));
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->instant.count(), kCameras) << frame;
  }
}

TEST_F(InstantsTest, TakesTheNewestAndCountsWhatItSkips) {
  for (int f = 0; f < 4; ++f)
    for (size_t c = 0; c < kCameras; ++c) send(c, f);
  const auto taken = instants.take(timeOf(3, 30'000));
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->instant.slot, kBegin_us / kPeriod_us + 3);
  ASSERT_EQ(taken->skipped.size(), 3u);
  EXPECT_EQ(taken->skipped[0].slot, kBegin_us / kPeriod_us);
  EXPECT_EQ(instants.skipped(), 3u);
  EXPECT_FALSE(send(0, 2));
}

TEST_F(InstantsTest, HoldsFewPicturesWhenNobodyTakesThem) {
  size_t most = 0;
  for (int f = 0; f < 1000; ++f)
    for (size_t c = 0; c < kCameras; ++c) send(c, f), most = std::max(most, instants.held());
  EXPECT_LE(most, 8u);
  ASSERT_TRUE(instants.take(timeOf(999, 30'000)));
}

TEST_F(InstantsTest, ArrivalInAnyOrderMakesTheSameInstants) {
  std::mt19937 random(5);
  struct Sent {
    size_t camera;
    int frame;
    int64_t at_us;
  };
  std::vector<Sent> all;
  std::uniform_int_distribution<int64_t> delay_us(1000, 35'000);
  for (int f = 0; f < 200; ++f)
    for (size_t c = 0; c < kCameras; ++c) all.push_back({c, f, timeOf(f) + delay_us(random)});
  std::sort(all.begin(), all.end(), [](const Sent& a, const Sent& b) { return a.at_us < b.at_us; });
  int complete = 0;
  for (const Sent& sent : all) {
    EXPECT_TRUE(instants.add(sent.camera, pictureAt(timeOf(sent.frame)), sent.at_us));
    const auto taken = instants.take(sent.at_us);
    complete += taken && taken->instant.complete;
  }
  EXPECT_EQ(complete, 200);
}

TEST_F(InstantsTest, DoesNotBelieveTimesOfTheFuture) {
  EXPECT_FALSE(instants.add(0, pictureAt(timeOf(0, 3'000'000)), timeOf(0)));
  EXPECT_FALSE(instants.add(1, pictureAt(timeOf(0, -60'000'000)), timeOf(0)));
  EXPECT_EQ(instants.held(), 0u);
  EXPECT_EQ(instants.late(0), 1u);
}

TEST_F(InstantsTest, GoesOnWhenTheServersClockIsSetBack) {
  for (size_t c = 0; c < kCameras; ++c) send(c, 1000);
  ASSERT_TRUE(instants.take(timeOf(1000, 30'000)));
  for (size_t c = 0; c < kCameras; ++c) EXPECT_TRUE(send(c, 5));
  const auto taken = instants.take(timeOf(5, 30'000));
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->instant.count(), kCameras);
}

}  // namespace
}  // namespace fourdvt::live

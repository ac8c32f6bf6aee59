// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>

#include "live/server/instants.h"

namespace fourdvt::live {
namespace {

constexpr int64_t kStart_us = 1'800'000'000'000'000;

// Adds an answer of a camera whose clock is `offset_us` ahead, with these latencies of question and answer.
void answer(ClockOffset& clock, int64_t at_us, int64_t offset_us, int64_t there_us, int64_t back_us) {
  clock.add({at_us, at_us + there_us + offset_us}, at_us + there_us + back_us);
}

TEST(ClockOffset, IsExactWhereBothWaysTakeTheSame) {
  for (const int64_t offset_us : {int64_t(0), int64_t(3'000'000), int64_t(-3'000'000), -kStart_us / 2}) {
    ClockOffset clock;
    EXPECT_FALSE(clock.known());
    answer(clock, kStart_us, offset_us, 2000, 2000);
    ASSERT_TRUE(clock.known());
    EXPECT_EQ(clock.offset_us(), offset_us);
    EXPECT_EQ(clock.toServer(kStart_us + offset_us), kStart_us);
  }
}

TEST(ClockOffset, TheShortestRoundTripsDecide) {
  ClockOffset clock;
  for (int i = 0; i < 32; ++i) {
    const bool quick = i % 8 == 3;  // answers of others are delayed by up to 190 ms
    answer(clock, kStart_us + i * 1'000'000, 3'000'000, 1000, quick ? 1200 : 50'000 + 20'000 * (i % 8));
  }
  EXPECT_NEAR(double(clock.offset_us()), 3'000'000, 101);  // half the difference between the quick ones' latencies
}

TEST(ClockOffset, IsWrongByNoMoreThanHalfTheShortestRoundTrip) {
  ClockOffset clock;
  for (int i = 0; i < 8; ++i) answer(clock, kStart_us + i * 1'000'000, 0, 0, 4000 + 5000 * i);
  EXPECT_LE(std::abs(clock.offset_us()), 2000);
}

TEST(ClockOffset, FollowsAClockThatDrifts) {
  ClockOffset clock;
  int64_t offset_us = 0;
  for (int i = 0; i < 600; ++i) {
    offset_us = i * 100;  // 100 ppm, one question per second
    answer(clock, kStart_us + i * 1'000'000, offset_us, 1000 + i % 5, 1000);
  }
  EXPECT_LT(std::abs(clock.offset_us() - offset_us), 1700);  // drift over sixteen answers
}

TEST(ClockOffset, BeginsAnewAfterAJump) {
  ClockOffset clock;
  for (int i = 0; i < 16; ++i) answer(clock, kStart_us + i * 1'000'000, 0, 500, 500);
  answer(clock, kStart_us + 20'000'000, 400'000, 2000, 2000);
  EXPECT_EQ(clock.offset_us(), 400'000);
}

TEST(ClockOffset, DoesNotTakeADelayForAJump) {
  ClockOffset clock;
  for (int i = 0; i < 16; ++i) answer(clock, kStart_us + i * 1'000'000, 0, 500, 500);
  answer(clock, kStart_us + 20'000'000, 0, 0, 900'000);  // looks like an offset of -450 ms
  EXPECT_EQ(clock.offset_us(), 0);
}

TEST(ClockOffset, LeavesOutImpossibleAnswers) {
  ClockOffset clock;
  clock.add({kStart_us + 1, kStart_us}, kStart_us);          // to a question in the future
  clock.add({kStart_us - 6'000'000, kStart_us}, kStart_us);  // too long ago
  clock.add({kStart_us, INT64_MAX}, kStart_us);              // invalid time
  clock.add({INT64_MIN, kStart_us}, kStart_us);
  EXPECT_FALSE(clock.known());
}

}  // namespace
}  // namespace fourdvt::live

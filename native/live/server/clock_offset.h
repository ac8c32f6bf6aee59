// SPDX-License-Identifier: Apache-2.0
// A camera's clock against the server's, from questions and answers as in NTP: of the last answers, those with the
// shortest round trips decide. Does NOT read clocks.
#pragma once

#include <cstdint>
#include <deque>

#include "live/protocol/camera_messages.h"

namespace fourdvt::live {

class ClockOffset {
 public:
  // `now_us`: by the server's clock, when the answer came. Answers to questions that cannot have been put (from the
  // future, or more than kMostRoundTrip_us ago) are left out. A camera whose clock jumps by more than kJump_us begins
  // anew.
  void add(const ClockAnswer& answer, int64_t now_us);
  void reset() { answers_.clear(); }
  bool known() const { return !answers_.empty(); }
  int64_t offset_us() const { return offset_us_; }  // camera's clock minus server's; 0 before the first answer
  int64_t toServer(int64_t camera_us) const { return camera_us - offset_us_; }

  static constexpr int64_t kMostRoundTrip_us = 5'000'000, kJump_us = 250'000;
  static constexpr int64_t kLatest_us = int64_t(1) << 60;  // times beyond are no times

 private:
  struct Answer {
    int64_t round_trip_us, offset_us;
  };
  void decide();

  std::deque<Answer> answers_;
  int64_t offset_us_ = 0;
};

}  // namespace fourdvt::live

// SPDX-License-Identifier: Apache-2.0
#include "live/server/clock_offset.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace fourdvt::live {
namespace {

constexpr size_t kAnswers = 16, kDeciding = 4;
constexpr int64_t kMuchLonger_us = 2000;  // than the shortest round trip: such an answer does not decide

}  // namespace

void ClockOffset::add(const ClockAnswer& answer, int64_t now_us) {
  if (std::max(std::abs(answer.camera_us), std::abs(now_us)) > kLatest_us) return;
  if (answer.server_us > now_us || answer.server_us < now_us - kMostRoundTrip_us) return;
  const int64_t round_trip_us = now_us - answer.server_us;
  const Answer next{round_trip_us, answer.camera_us - (answer.server_us + round_trip_us / 2)};
  // The true offset lies within half of the round trip round an answer's.
  if (known() && std::abs(next.offset_us - offset_us_) > kJump_us + round_trip_us / 2) answers_.clear();
  answers_.push_back(next);
  if (answers_.size() > kAnswers) answers_.pop_front();
  decide();
}

void ClockOffset::decide() {
  std::vector<Answer> sorted(answers_.begin(), answers_.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Answer& a, const Answer& b) { return a.round_trip_us < b.round_trip_us; });
  const int64_t base_us = sorted[0].offset_us, longest_us = sorted[0].round_trip_us + kMuchLonger_us;
  int64_t sum_us = 0, count = 0;  // of differences: offsets themselves may be large
  for (size_t i = 0; i < std::min(kDeciding, sorted.size()) && sorted[i].round_trip_us <= longest_us; ++i, ++count)
    sum_us += sorted[i].offset_us - base_us;
  offset_us_ = base_us + sum_us / count;
}

}  // namespace fourdvt::live

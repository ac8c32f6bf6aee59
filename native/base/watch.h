// SPDX-License-Identifier: Apache-2.0
// Elapsed time, and the progress that long commands report.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace fourdvt {

// Stopwatch on the monotonic clock, started at construction.
class Watch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  double ms() const { return 1e3 * seconds(); }
  // Returns the milliseconds since the start or the last lap, and restarts.
  double lap_ms() {
    const double passed_ms = ms();
    start_ = Clock::now();
    return passed_ms;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

struct FrameProgress {
  std::string stage;                    // "mattes run 12/28"
  uint32_t done = 0, total = 0;         // frames; total 0: unknown
  double frames_per_s = 0, left_s = 0;  // 0: unknown
};

}  // namespace fourdvt

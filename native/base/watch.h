// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

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

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace fourdvt {

// Measures time by the monotonic clock, from its construction or its last lap on.
class Watch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  double ms() const { return 1e3 * seconds(); }
  // Milliseconds so far; starts again.
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

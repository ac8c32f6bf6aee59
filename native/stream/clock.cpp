// SPDX-License-Identifier: Apache-2.0
#include "stream/clock.h"

#include <algorithm>

namespace fourdvt::stream {

void PlaybackClock::advance(double now_s, double max_step_s) {
  const double step_s = started_ ? std::clamp(now_s - last_now_s_, 0.0, max_step_s) : 0.0;
  started_ = true;
  last_now_s_ = std::max(now_s, last_now_s_);
  if (running_) position_s_ += step_s * rate_;
}

}  // namespace fourdvt::stream

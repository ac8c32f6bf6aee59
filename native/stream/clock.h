// SPDX-License-Identifier: Apache-2.0
// Media time against the edge's monotonic clock. Pure logic. Does NOT know frames or loops: position is unwrapped.
#pragma once

namespace fourdvt::stream {

class PlaybackClock {
 public:
  void setRunning(bool running) { running_ = running; }
  void setRate(double rate) { rate_ = rate; }
  void jump(double position_s) { position_s_ = position_s; }
  // Moves to `now_s`; a step longer than `max_step_s` (a sleeping tab) counts as that long. Going back counts as 0.
  void advance(double now_s, double max_step_s = 0.25);
  // Keeps the position from passing `limit_s`: playback waits for pictures instead of running away from them.
  void holdAt(double limit_s) {
    if (position_s_ > limit_s) position_s_ = limit_s;
  }
  double position() const { return position_s_; }
  double rate() const { return rate_; }
  bool running() const { return running_; }

 private:
  double position_s_ = 0, rate_ = 1, last_now_s_ = 0;
  bool running_ = false, started_ = false;
};

}  // namespace fourdvt::stream

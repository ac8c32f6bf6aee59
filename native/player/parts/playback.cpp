// SPDX-License-Identifier: Apache-2.0
#include "player/parts/playback.h"

#include <algorithm>
#include <cmath>

namespace fourdvt {

namespace {
constexpr double kStarvedBeforeWaiting_s = 0.25;
constexpr double kTimeUpdatePeriod_s = 0.25;
constexpr double kMaxRate = 4;
}  // namespace

bool Playback::play() {
  if (playing_) return false;
  return playing_ = true;
}

bool Playback::pause() {
  if (!playing_) return false;
  playing_ = waiting_ = false;
  outbox_.emit(EventKind::Paused);
  return true;
}

void Playback::end() {
  playing_ = false;
  for (EventKind kind : {EventKind::TimeUpdate, EventKind::Paused, EventKind::Ended}) outbox_.emit(kind);
}

void Playback::setRate(double rate) {
  held_ = rate == 0;
  if (rate > 0) rate_ = std::min(rate, kMaxRate);
}

void Playback::setLoop(int loop) { loop_override_ = std::clamp(loop, -1, 1); }

bool Playback::loops(const package::Sequence& sequence) const {
  return loop_override_ < 0 ? sequence.loop : loop_override_ == 1;
}

void Playback::tick(double now_s) {
  tick_s_ = ticked_ ? std::clamp(now_s - now_s_, 0.0, kMaxStep_s) : 0;
  ticked_ = true;
  now_s_ = now_s;
}

void Playback::finishTick(bool seeking) {
  if (!running() || seeking || now_s_ - last_time_update_s_ < kTimeUpdatePeriod_s) return;
  last_time_update_s_ = now_s_;
  outbox_.emit(EventKind::TimeUpdate);
}

void Playback::finishSeek(bool sequence_changed) {
  forgetStarvation();
  waiting_ = false;
  if (!can_play_) {
    can_play_ = true;
    outbox_.emit(EventKind::CanPlay);
  }
  if (sequence_changed) outbox_.emit(EventKind::SequenceChanged);
  if (seek_requested_) outbox_.emit(EventKind::Seeked);
  seek_requested_ = false;
  if (playing_) emitPlaying();
}

void Playback::noteStarvation(bool starved) {
  if (!starved) {
    forgetStarvation();
    if (waiting_ && playing_) emitPlaying();
    waiting_ = false;
    return;
  }
  if (starved_since_s_ < 0) starved_since_s_ = now_s_;
  if (waiting_ || now_s_ - starved_since_s_ <= kStarvedBeforeWaiting_s) return;
  waiting_ = true;
  outbox_.emit(EventKind::Waiting);
}

void PlaybackClock::advance(double now_s, double max_step_s) {
  const double step_s = started_ ? std::clamp(now_s - last_now_s_, 0.0, max_step_s) : 0.0;
  started_ = true;
  last_now_s_ = std::max(now_s, last_now_s_);
  if (running_) position_s_ += step_s * rate_;
}

void Playhead::seek(int64_t k, double fps) {
  wanted_k_ = k;
  seeking_ = true;
  ended_ = false;
  clock_.jump(static_cast<double>(k) / fps);
  clock_.setRunning(false);
}

void Playhead::seekShown() {
  wanted_k_ = shown_.k;
  seeking_ = true;
  clock_.setRunning(false);
}

int64_t Playhead::dueK(double fps) const { return static_cast<int64_t>(std::floor(clockFrames(fps) + 1e-6)); }

int Playhead::choose(const PictureSlots& slots, double fps) const {
  return seeking_ ? slots.findReady(wanted_k_) : slots.newestReady(shown_.k + 1, dueK(fps));
}

void Playhead::finishSeek(double fps) {
  seeking_ = false;
  clock_.jump(static_cast<double>(shown_.k) / fps);
}

void Playhead::holdAtNewest(const PictureSlots& slots, double fps) {
  const int newest = slots.newestReady(shown_.k, INT64_MAX);
  const int64_t newest_k = newest < 0 ? shown_.k : slots.k(newest);
  clock_.holdAt(static_cast<double>(newest_k + 1) / fps);
}

bool Playhead::pastShown(double fps) const { return clockFrames(fps) >= static_cast<double>(shown_.k + 1) - 1e-6; }

void Playhead::end() {
  ended_ = true;
  clock_.setRunning(false);
}

void Playhead::close() {
  clock_.setRunning(false);
  sequence_ = -1;
  shown_ = {};
}

void Playhead::advance(double now_s, double rate, double max_step_s) {
  clock_.setRate(rate);
  clock_.advance(now_s, max_step_s);
}

}  // namespace fourdvt

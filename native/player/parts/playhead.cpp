// SPDX-License-Identifier: Apache-2.0
#include "player/parts/playhead.h"

#include <algorithm>
#include <cmath>

namespace fourdvt {

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

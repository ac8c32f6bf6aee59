// SPDX-License-Identifier: Apache-2.0
// Where one track is: the sequence that it plays, the presentation that is wanted, the one on screen, and the clock
// that leads from one to the next. A presentation k counts frames since the sequence's start, unwrapped over loops.
// Does NOT hold pictures: it names slots of PictureSlots. Does NOT know whether the player plays: it is told to run.
#pragma once

#include "package/character.h"
#include "player/parts/picture_slots.h"
#include "stream/clock.h"

namespace fourdvt {

// What is on screen.
struct Presentation {
  int slot = -1;      // -1: nothing
  int sequence = -1;  // may differ from the wanted one until that is ready
  int64_t k = 0;
};

class Playhead {
 public:
  bool used() const { return sequence_ >= 0; }
  int sequence() const { return sequence_; }  // wanted; -1: not in use
  bool seeking() const { return seeking_; }   // the wanted presentation is not on screen yet
  bool ended() const { return ended_; }
  int64_t wantedK() const { return wanted_k_; }
  const Presentation& shown() const { return shown_; }
  bool hasPicture() const { return shown_.slot >= 0; }
  int64_t position() const { return seeking_ ? wanted_k_ : shown_.k; }  // what must be at hand next

  void select(int sequence) { sequence_ = sequence; }
  void seek(int64_t k, double fps);  // of the wanted sequence; the clock stands until it is on screen
  void seekShown();                  // wants again what is on screen, to be fed anew from there
  // The ready picture to show next; -1: none. While seeking the wanted one, else the newest that is due by the clock.
  int choose(const PictureSlots& slots, double fps) const;
  bool isLate(double fps) const { return dueK(fps) > shown_.k; }  // a newer presentation than the shown one is due
  void show(int slot, int64_t k) { shown_ = {slot, sequence_, k}; }
  void finishSeek(double fps);  // the wanted presentation is shown
  // Playback waits for pictures instead of running away from them.
  void holdAtNewest(const PictureSlots& slots, double fps);
  bool pastShown(double fps) const;  // the shown presentation's time is over
  void end();
  void close();

  void advance(double now_s, double rate, double max_step_s);
  void setRunning(bool running) { clock_.setRunning(running); }
  double clockFrames(double fps) const { return clock_.position() * fps; }  // presentation by the clock, with fraction
  const stream::PlaybackClock& clock() const { return clock_; }

 private:
  int64_t dueK(double fps) const;

  int sequence_ = -1;
  bool seeking_ = true, ended_ = false;
  int64_t wanted_k_ = 0;  // while seeking or paused
  Presentation shown_;
  stream::PlaybackClock clock_;  // seconds at the sequence's own fps, whatever the weights
};

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
// Time of the whole player (Playback) and of one track (Playhead, on a PlaybackClock).
#pragma once

#include "package/character.h"
#include "player/parts/messages.h"
#include "player/parts/pictures.h"

namespace fourdvt {

constexpr double kMaxStep_s = 0.25;  // limit of a tick's duration (suspended tab)

// State of the whole player, independent of its tracks: playing or paused, rate, loop, the edge's time; and the media
// element events that follow from them. Frames are chosen by Playhead.
class Playback {
 public:
  explicit Playback(Outbox& outbox) : outbox_(outbox) {}

  bool playing() const { return playing_; }
  bool running() const { return playing_ && !held_; }  // time advances
  bool canPlay() const { return can_play_; }           // a picture of the streams has been shown
  bool play();                                         // false: already playing
  bool pause();                                        // false: already paused. Emits Paused.
  void end();                                          // Emits TimeUpdate, Paused, Ended.
  void emitPlaying() { outbox_.emit(EventKind::Playing); }

  void setRate(double rate);             // 0 <= rate <= 4; 0 freezes the shown frame
  double rate() const { return rate_; }  // last rate above 0
  void setLoop(int loop);                // -1: as the sequence, 0: never, 1: always
  bool loops(const package::Sequence& sequence) const;

  void tick(double now_s);
  double now_s() const { return now_s_; }
  double tick_s() const { return tick_s_; }  // between the last two ticks, at most kMaxStep_s
  // Ends the tick. Emits TimeUpdate at intervals during motion.
  void finishTick(bool seeking);

  void requestSeek() { seek_requested_ = true; }  // Seeked will follow
  // Completes a seek with its picture on screen. Emits CanPlay (once), SequenceChanged, Seeked, Playing, as applicable.
  void finishSeek(bool sequence_changed);
  // Call at every playing tick; starved: a picture is due and missing. Emits Waiting after a delay, then Playing.
  void noteStarvation(bool starved);
  void forgetStarvation() { starved_since_s_ = -1; }

 private:
  Outbox& outbox_;
  bool playing_ = false, held_ = false, waiting_ = false, can_play_ = false, seek_requested_ = false;
  int loop_override_ = -1;
  double rate_ = 1;
  double now_s_ = 0, tick_s_ = 0;
  bool ticked_ = false;
  double last_time_update_s_ = -1, starved_since_s_ = -1;  // -1: not starved
};

// Media time against the edge's monotonic clock. Pure logic without frames or loops: the position is unwrapped.
class PlaybackClock {
 public:
  void setRunning(bool running) { running_ = running; }
  void setRate(double rate) { rate_ = rate; }
  void jump(double position_s) { position_s_ = position_s; }
  // Moves to `now_s` by at most `max_step_s` (suspended tab). Backward steps count as 0.
  void advance(double now_s, double max_step_s = 0.25);
  // Limits the position to `limit_s`: playback waits for pictures.
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

// Picture on screen.
struct Presentation {
  int slot = -1;      // -1: none
  int sequence = -1;  // differs from the requested sequence until that is ready
  int64_t k = 0;
};

// Position of one track: its sequence, the requested presentation, the one on screen, and the clock in between. A
// presentation k counts frames since the sequence's start, unwrapped over loops. Refers to pictures by their slots
// (PictureSlots).
class Playhead {
 public:
  bool used() const { return sequence_ >= 0; }
  int sequence() const { return sequence_; }  // requested sequence; -1: not in use
  bool seeking() const { return seeking_; }   // the requested presentation is not on screen yet
  bool ended() const { return ended_; }
  int64_t wantedK() const { return wanted_k_; }
  const Presentation& shown() const { return shown_; }
  bool hasPicture() const { return shown_.slot >= 0; }
  int64_t position() const { return seeking_ ? wanted_k_ : shown_.k; }  // next presentation needed

  void select(int sequence) { sequence_ = sequence; }
  void seek(int64_t k, double fps);  // requests k of the requested sequence; the clock stops until it is on screen
  void seekShown();                  // requests the shown presentation again, to feed from there
  // Next ready picture to show; -1: none. While seeking the requested one, else the newest one due.
  int choose(const PictureSlots& slots, double fps) const;
  bool isLate(double fps) const { return dueK(fps) > shown_.k; }  // a presentation after the shown one is due
  void show(int slot, int64_t k) { shown_ = {slot, sequence_, k}; }
  void finishSeek(double fps);  // requested presentation shown
  // Limits the clock to the newest ready picture.
  void holdAtNewest(const PictureSlots& slots, double fps);
  bool pastShown(double fps) const;  // the shown presentation's duration has passed
  void end();
  void close();

  void advance(double now_s, double rate, double max_step_s);
  void setRunning(bool running) { clock_.setRunning(running); }
  double clockFrames(double fps) const { return clock_.position() * fps; }  // presentation by the clock, fractional
  const PlaybackClock& clock() const { return clock_; }

 private:
  int64_t dueK(double fps) const;

  int sequence_ = -1;
  bool seeking_ = true, ended_ = false;
  int64_t wanted_k_ = 0;  // valid while seeking or paused
  Presentation shown_;
  PlaybackClock clock_;  // seconds at the sequence's own fps, independent of the weights
};

}  // namespace fourdvt

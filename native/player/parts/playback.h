// SPDX-License-Identifier: Apache-2.0
// What holds for the whole player whatever its tracks do: playing or paused, rate, loop, the edge's time; and the
// events of a media element that follow from them. Does NOT choose frames (playhead.h) and does NOT know sequences.
#pragma once

#include "package/character.h"
#include "player/parts/outbox.h"

namespace fourdvt {

constexpr double kMaxStep_s = 0.25;  // a longer time between two ticks (a sleeping tab) counts as this

class Playback {
 public:
  explicit Playback(Outbox& outbox) : outbox_(outbox) {}

  bool playing() const { return playing_; }
  bool running() const { return playing_ && !held_; }  // time goes on
  bool canPlay() const { return can_play_; }           // a picture of the streams has been shown
  bool play();                                         // false: it plays already
  bool pause();                                        // false: it is paused already. Emits Paused.
  void end();                                          // Emits TimeUpdate, Paused, Ended.
  void emitPlaying() { outbox_.emit(EventKind::Playing); }

  void setRate(double rate);             // 0 <= rate <= 4; 0: playing goes on with the shown frame
  double rate() const { return rate_; }  // above 0: that of before, where it is held
  void setLoop(int loop);                // -1 as the sequence says, 0 never, 1 always
  bool loops(const package::Sequence& sequence) const;

  void tick(double now_s);
  double now_s() const { return now_s_; }
  double tick_s() const { return tick_s_; }  // between the last two ticks, at most kMaxStep_s
  // The tick is over. Emits TimeUpdate now and then while a motion goes on.
  void finishTick(bool seeking);

  void requestSeek() { seek_requested_ = true; }  // Seeked follows
  // The wanted picture is on screen. Emits CanPlay (once), SequenceChanged, Seeked, Playing, as they apply.
  void finishSeek(bool sequence_changed);
  // At every tick that plays: no picture is there although one is due. Emits Waiting after a while, then Playing.
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

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
// Private to native/player: one sequence that is being played by one decoder: what is fed and decoded, its clock, what
// it shows. A player has one track, and a second one round a transition.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "motion/parameter_space.h"
#include "render/appearance.h"
#include "stream/clock.h"

namespace fourdvt {

struct Slot {
  enum class State { Free, Filling, Ready } state = State::Free;
  int sequence = -1;
  int64_t k = 0;       // presentation: frames since the sequence's start, unwrapped over loops
  uint32_t epoch = 0;  // feed restart it belongs to
  bool wrong_frame = false;
  int width = 0, height = 0;
  render::PictureTextures picture;
};

struct Shown {
  int slot = -1;
  int sequence = -1;
  int64_t k = 0;
};

struct Track {
  int decoder = 0;    // its index among the player's tracks as well
  int sequence = -1;  // wanted; -1: not in use

  // Feeding: samples go out in decoding order from a GOP's start; pictures before `drop_before_k` are not shown.
  bool feeding = false, configured = false, flushed = false;
  int configured_sequence = -1;
  uint32_t epoch = 0;
  int64_t feed_gop_k = 0;  // presentation of the first frame of the GOP being fed
  uint32_t feed_gop = 0, feed_sample = 0;
  bool feed_done = false;  // a sequence that does not loop is fed to its end
  int64_t drop_before_k = 0;
  int64_t serial_base = 0, next_serial = 0;
  std::map<int64_t, int64_t> in_flight;  // timestamp → k
  size_t reorder_allowance = 4;          // samples the decoder may hold beyond the slots; grows if it holds more
  int ticks_without_output = 0;
  std::vector<Slot> slots;

  stream::PlaybackClock clock;  // seconds at the sequence's own fps, whatever the weights
  bool seeking = true, ended = false;
  int64_t wanted_k = 0;  // while seeking or paused
  Shown shown;

  // Of the shown sequence:
  std::optional<render::Appearance> appearance;
  std::vector<double> at;        // parameter values
  std::vector<double> entry_at;  // of the next sequence to show; empty: the wanted ones
  motion::BlendWeights weights;
  std::array<glm::vec3, package::kMaxMembers> roots{};  // of the shown frame
  Positions positions;
  bool stale = false;  // positions are not those of the shown frame at these weights

  bool used() const { return sequence >= 0; }
};

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
// Decoding of geometry in slices: how a tick's share is spent.
#include <algorithm>

#include "player/parts/loading.h"

namespace fourdvt {

namespace {
constexpr uint32_t kRowsAhead = 12;  // after the frame that is shown or sought
// While seeking, when nothing moves until the frame is there: half the time between ticks, between so many slices.
constexpr double kMinSlices = 3, kMaxSlices = 8;
}  // namespace

// Counts down a tick's share of decoding.
struct Loading::SliceLeft {
  const DecodeSlice& slice;
  uint32_t steps = slice.steps;
  double end_s = 0;
  // The first is granted however short the time: what is sought comes at last.
  bool takeStep() {
    const bool late = slice.now_s && slice.now_s() >= end_s;
    if (steps == 0 || (late && steps < slice.steps)) return false;
    --steps;
    return true;
  }
};

void Loading::decodeAhead(std::span<const Need> needs, bool seeking) {
  if (!slice_ || mesh_state_ != stream::PartState::Present) return;
  SliceLeft left{*slice_};
  const double least_s = slice_->seconds * kMinSlices, most_s = slice_->seconds * kMaxSlices;
  if (slice_->now_s)
    left.end_s = slice_->now_s() + (seeking ? std::clamp(tick_s_ / 2, least_s, most_s) : slice_->seconds);
  for (uint32_t ahead = 0; ahead <= kRowsAhead; ++ahead)
    for (const Need& need : needs)
      if (!decodeAhead(need, ahead, left)) return;
}

// False: the tick's share is used up. A chunk that does not decode is left to `geometry`, which reports it.
bool Loading::decodeAhead(const Need& need, uint32_t ahead, SliceLeft& left) {
  if (!playable(need.sequence)) return true;
  const package::StreamIndex& streamed = index(need.sequence);
  uint32_t frame = need.frame + ahead;
  if (frame >= streamed.frame_count && !need.loops) return true;
  frame %= streamed.frame_count;
  const stream::GopKey key{need.sequence, streamed.chunkOfFrame(frame)};
  stream::Gop* gop = cache_.find(key);
  if (!gop || gop->chunk_state != stream::PartState::Present) return true;
  const uint32_t row = frame - streamed.chunks[key.gop].first_frame;
  if (ahead == 0)
    enter(*gop, row);
  else if (!gop->decoded())
    takeFine(*gop);
  while (gop->decodedRows() <= row) {
    if (ahead > 0 && !cache_.hasRoomForDecoded()) return true;
    if (!left.takeStep()) return false;
    if (!decode(key, *gop, kStep).ok()) return true;
  }
  return true;
}

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
// Choice of renditions: which one of a GOP is fetched, and when it comes again in another one.
#include <algorithm>

#include "player/parts/loading.h"

namespace fourdvt {

using Kind = FetchPurpose::Kind;

namespace {

constexpr double kStill_s = 2;    // that a standing picture may take to come in its best rendition
constexpr double kRaise_s = 1.5;  // that a whole sequence may, in place of a rendition between

}  // namespace

uint32_t Loading::renditionOf(int sequence_index, uint32_t gop) const {
  const Gop* held = cache_.find({sequence_index, gop});
  return held && held->video_state != PartState::Absent
             ? held->rendition
             : ladder_.choose(sequence(sequence_index), stream(sequence_index).rendition);
}

// The first picture comes in the lowest rendition; that of the start file is shown before its sequence.
uint32_t Loading::choose(GopKey key, double ahead_s, bool stands) const {
  const package::Sequence& q = sequence(key.sequence);
  if (!ladder_.automatic()) return ladder_.choose(q, 0);
  if (!fetches_.progressEnded() && !(started_ && key.sequence == 0)) return ladder_.lowest(q);
  return stands ? chooseStill(key) : ladder_.choose(q, stream(key.sequence).rendition, ahead_s);
}

// The highest whose bytes of the GOP come in time, whatever the rate of the rest.
uint32_t Loading::chooseStill(GopKey key) const {
  const package::Sequence& q = sequence(key.sequence);
  const package::StreamIndex& streamed = index(key.sequence);
  const double most_bytes = ladder_.throughput_bps() / 8 * kStill_s;
  for (uint32_t r = ladder_.highest(q); r > ladder_.lowest(q); --r) {
    const auto& chunks = q.hasCoarseGeometry(r) ? stream(key.sequence).coarse.chunks : streamed.chunks;
    const double bytes = double(streamed.renditions[r].videoOf(key.gop).bytes) + chunks[key.gop].bytes;
    if (!ladder_.isOut(q, r) && bytes <= most_bytes) return r;
  }
  return ladder_.lowest(q);
}

// Nothing is on its way: a loop that is held whole, and the GOP of a standing picture, which is the first, comes again
// in a higher rendition, one GOP after the other, the lowest first.
void Loading::raise(const std::vector<GopKey>& keys, bool stands) {
  GopKey chosen;
  Gop* lowest = nullptr;
  for (const GopKey& key : keys) {
    Gop* gop = cache_.find(key);
    if (!gop || gop->rendition >= ladder_.highest(sequence(key.sequence)) || gop->better_state != PartState::Absent)
      continue;
    if (!(stands && key == keys[0]) && !holdsWhole(key.sequence)) continue;
    if (lowest && lowest->rendition <= gop->rendition) continue;
    lowest = gop;
    chosen = key;
  }
  if (!lowest) return;
  lowest->better_rendition = raised(chosen.sequence, lowest->rendition);
  lowest->better_state = PartState::Fetching;
  if (!sequence(chosen.sequence).hasCoarseGeometry(lowest->better_rendition)) requestFine(chosen, *lowest);
  requestVideo(chosen, Kind::Better, lowest->better_rendition);
}

// The highest rendition, or a nearer one where that is known to take long.
uint32_t Loading::raised(int sequence_index, uint32_t from) const {
  const package::Sequence& q = sequence(sequence_index);
  const double most_bytes = ladder_.throughput_bps() / 8 * kRaise_s;
  uint32_t to = ladder_.highest(q);
  if (most_bytes <= 0) return to;
  for (uint32_t r = to; r > from; --r) {
    if (ladder_.isOut(q, r)) continue;
    to = r;
    if (double(q.renditions[r].video_bytes) <= most_bytes) break;
  }
  return to;
}

bool Loading::holdsWhole(int sequence) const {
  for (uint32_t g = 0; g < index(sequence).chunks.size(); ++g)
    if (!video(sequence, g)) return false;
  return true;
}

bool Loading::takeSharper(int sequence_index, uint32_t gop_index, uint32_t rendition) {
  Gop* gop = cache_.find({sequence_index, gop_index});
  if (!gop || gop->video_state != PartState::Present || gop->fine_state == PartState::Fetching) return false;
  const bool better = gop->better_state == PartState::Present && gop->better_rendition > gop->rendition;
  const uint32_t next = better ? gop->better_rendition : gop->rendition;
  const package::Sequence& q = sequence(sequence_index);
  if (next <= rendition || ladder_.tooSlow(q, next) || ladder_.isOut(q, next)) return false;
  gop->row = Gop::kNoRow;  // its decoding begins anew, with the fine geometry
  return true;
}

// A decoder is too slow for what is held: the nearest of it comes again in a lower rendition, and what is held plays
// until that is there.
void Loading::lower(const std::vector<GopKey>& keys) {
  int under_way = 0;
  for (const GopKey& key : keys) {
    Gop* gop = cache_.find(key);
    const package::Sequence& q = sequence(key.sequence);
    if (!gop || gop->video_state != PartState::Present || !ladder_.tooSlow(q, gop->rendition)) continue;
    const uint32_t rendition = ladder_.choose(q, 0);
    if (ladder_.tooSlow(q, rendition)) continue;
    if (gop->better_state == PartState::Absent ||
        (gop->better_state == PartState::Present && ladder_.tooSlow(q, gop->better_rendition))) {
      gop->better_rendition = rendition;
      gop->better_state = PartState::Fetching;
      requestVideo(key, Kind::Better, rendition);
    }
    under_way += gop->better_state == PartState::Fetching;
    if (under_way == kGopsOnTheirWay) return;
  }
}

// They would share the network with what is due.
void Loading::cancelRaises() {
  fetches_.cancel([&](const FetchPurpose& purpose) {
    const Gop* gop = cache_.find({purpose.sequence, purpose.gop});
    const bool raises =
        gop && (purpose.kind == Kind::Better
                    ? gop->better_rendition > gop->rendition
                    : purpose.kind == Kind::Fine && sequence(purpose.sequence).hasCoarseGeometry(gop->rendition));
    if (raises) *stateOf(purpose) = PartState::Absent;
    return raises;
  });
}

void Loading::takeBetter(int sequence_index, uint32_t gop_index) {
  Gop* gop = cache_.find({sequence_index, gop_index});
  if (!gop || gop->better_state != PartState::Present) return;
  const package::Sequence& q = sequence(sequence_index);
  if (!ladder_.tooSlow(q, gop->better_rendition) || ladder_.isOut(q, gop->rendition)) {
    gop->video = std::move(gop->better);
    gop->rendition = gop->better_rendition;
  }
  gop->better.clear();
  gop->better_state = PartState::Absent;
}

void Loading::dropOtherRenditions() {
  fetches_.cancel([&](const FetchPurpose& purpose) {
    if (!purpose.ofGop()) return false;
    if (PartState* state = stateOf(purpose)) *state = PartState::Absent;
    return true;
  });
  for (int s = 0; s < sequenceCount(); ++s) {
    if (!hasHeader(s)) continue;
    stream(s).rendition = ladder_.choose(sequence(s), stream(s).rendition);
    for (uint32_t g = 0; g < index(s).chunks.size(); ++g) {
      Gop* gop = cache_.find({s, g});
      if (!gop) continue;
      gop->better_state = gop->fine_state = PartState::Absent;
      gop->better.clear();
      gop->fine.clear();
      if (gop->coarse && !sequence(s).hasCoarseGeometry(stream(s).rendition)) {
        gop->chunk_state = PartState::Absent;
        gop->dropDecoded();
        gop->chunk.clear();
      }
      if (gop->video_state != PartState::Present || gop->rendition == stream(s).rendition) continue;
      gop->video_state = PartState::Absent;
      gop->video.clear();
    }
  }
}

}  // namespace fourdvt

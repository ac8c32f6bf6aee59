// SPDX-License-Identifier: Apache-2.0
// Rendition choice: which one of a GOP is fetched, and when another replaces it.
#include <algorithm>

#include "player/parts/loading.h"

namespace fourdvt {

using Kind = FetchPurpose::Kind;

namespace {

constexpr double kStill_s = 2;    // time limit for a standing picture's best rendition
constexpr double kRaise_s = 1.5;  // time limit for a whole sequence; above it an intermediate rendition is used

}  // namespace

uint32_t Loading::renditionOf(int sequence_index, uint32_t gop) const {
  const Gop* held = cache_.find({sequence_index, gop});
  return held && held->video_state != PartState::Absent
             ? held->rendition
             : ladder_.choose(sequence(sequence_index), stream(sequence_index).rendition);
}

// Lowest rendition for the first picture; the start file's picture precedes its sequence.
uint32_t Loading::choose(GopKey key, double ahead_s, bool stands) const {
  const package::Sequence& q = sequence(key.sequence);
  if (!ladder_.automatic()) return ladder_.choose(q, 0);
  if (!fetches_.progressEnded() && !(started_ && key.sequence == 0)) return ladder_.lowest(q);
  return stands ? chooseStill(key) : ladder_.choose(q, stream(key.sequence).rendition, ahead_s);
}

// Highest rendition whose bytes of this GOP arrive in time, regardless of the other GOPs' bitrate.
uint32_t Loading::chooseStill(GopKey key) const {
  const package::Sequence& q = sequence(key.sequence);
  const package::StreamIndex& streamed = index(key.sequence);
  const double max_bytes = ladder_.throughput_bps() / 8 * kStill_s;
  for (uint32_t r = ladder_.highest(q); r > ladder_.lowest(q); --r) {
    const auto& chunks = q.hasCoarseGeometry(r) ? stream(key.sequence).coarse.chunks : streamed.chunks;
    const double bytes = double(streamed.renditions[r].videoOf(key.gop).bytes) + chunks[key.gop].bytes;
    if (!ladder_.isOut(q, r) && bytes <= max_bytes) return r;
  }
  return ladder_.lowest(q);
}

// Fetches one GOP in a higher rendition, the lowest one first, while the network is idle. Candidates: the GOP of a
// standing picture (the first key), and all GOPs of a loop that is held whole.
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

// Highest rendition, or an intermediate one if that is expected to take long.
uint32_t Loading::raised(int sequence_index, uint32_t from) const {
  const package::Sequence& q = sequence(sequence_index);
  const double max_bytes = ladder_.throughput_bps() / 8 * kRaise_s;
  uint32_t to = ladder_.highest(q);
  if (max_bytes <= 0) return to;
  for (uint32_t r = to; r > from; --r) {
    if (ladder_.isOut(q, r)) continue;
    to = r;
    if (double(q.renditions[r].video_bytes) <= max_bytes) break;
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
  gop->row = Gop::kNoRow;  // decoding restarts with the fine geometry
  return true;
}

// Fetches the nearest held GOPs in a lower rendition if the decoder is too slow; the held samples play until it
// arrives.
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

// Cancels raises, which would compete with due fetches for bandwidth.
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

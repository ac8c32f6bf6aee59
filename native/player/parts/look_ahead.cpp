// SPDX-License-Identifier: Apache-2.0
// Methods of Loading and Ladder that serve after the first picture only: the motion graph, judgements of renditions by
// the page, and prefetching the first GOPs of motions that may come next while the network is idle.
#include <algorithm>

#include "player/parts/loading.h"

namespace fourdvt {

using Kind = FetchPurpose::Kind;

namespace {
constexpr int kMostGops = 4;            // of one sequence: entries from all frames of a short loop
constexpr size_t kSoonGops = 2;         // nearest ones of a need
constexpr uint64_t kBudgetDivisor = 2;  // part of the budget that needs and beginnings fill together at most
}  // namespace

// A graph that cannot be read counts as none: states are then simply selected.
void Loading::receiveGraph(std::span<const uint8_t> bytes) {
  auto graph = motion::MotionGraph::read(bytes, *character_);
  graph_state_ = graph.ok() ? PartState::Present : PartState::Failed;
  if (graph.ok()) graph_ = graph.take();
}

void Ladder::judge(const package::Sequence& s, uint32_t rendition, bool plays) {
  std::vector<const package::Rendition*>& list = plays ? rough_ : missing_;
  list.push_back(&s.renditions[rendition]);
  if (allOut(s)) list.pop_back();
}

bool Loading::holds(int sequence, uint32_t gop_index) const {
  const Gop* gop = cache_.find({sequence, gop_index});
  return gop && gop->video_state == PartState::Present && gop->chunk_state == PartState::Present;
}

void Loading::fetchAhead(std::span<const Landing> landings) {
  if (!ladder_.automatic() || !fetches_.empty()) return;
  std::erase_if(ahead_, [&](const GopKey& key) {
    return std::none_of(landings.begin(), landings.end(), [&](const Landing& l) { return l.sequence == key.sequence; });
  });
  for (const Landing& l : landings) {
    Stream& s = stream(l.sequence);
    if (s.broken || s.failed_ahead) continue;
    requestHeader(l.sequence);
    if (hasHeader(l.sequence)) requestAhead({l.sequence, s.index.chunkOfFrame(l.frame)});
    if (fetches_.empty()) continue;
    fetches_.forEach([](Fetch& fetch) { fetch.purpose.ahead = true; });
    return;
  }
}

// Nothing where it is there, where there is no room for it, or enough of the sequence.
void Loading::requestAhead(GopKey key) {
  if (std::find(ahead_.begin(), ahead_.end(), key) == ahead_.end()) {
    const auto of_sequence = [&](const GopKey& other) { return other.sequence == key.sequence; };
    if (std::count_if(ahead_.begin(), ahead_.end(), of_sequence) >= kMostGops) return;
    ahead_.push_back(key);
  }
  const uint32_t rendition = ladder_.lowest(sequence(key.sequence));
  const package::StreamIndex& streamed = index(key.sequence);
  const uint64_t bytes = streamed.chunks[key.gop].bytes + streamed.renditions[rendition].videoOf(key.gop).bytes;
  if (needed_bytes_ + bytesOf(ahead_) + bytes > budget_bytes_ / kBudgetDivisor) return;
  Gop& gop = cache_.touch(key);
  if (gop.video_state == PartState::Absent) {
    gop.rendition = rendition;
    gop.video_state = PartState::Fetching;
    requestVideo(key, Kind::Video, rendition);
  }
  requestGop(key, 0);
}

uint64_t Loading::bytesOf(const std::vector<GopKey>& keys) const {
  uint64_t total = 0;
  for (size_t i = 0; i < keys.size(); ++i)
    if (const Gop* gop = cache_.find(keys[i]); gop && std::find(&keys[0], &keys[i], keys[i]) == &keys[i])
      total += gop->encodedBytes();
  return total;
}

// A beginning under way that has become a need stays; others are called off when a need is due soon that is under way,
// after a seek or for another motion. What fills the far end of the buffer comes beside them.
void Loading::settleAhead(std::span<const Need> needs, int next_sequence, const std::vector<GopKey>& keep) {
  const auto needed = [&](const FetchPurpose& p) {
    if (p.ofGop()) return std::find(keep.begin(), keep.end(), GopKey{p.sequence, p.gop}) != keep.end();
    return p.sequence == next_sequence ||
           std::any_of(needs.begin(), needs.end(), [&](const Need& need) { return need.sequence == p.sequence; });
  };
  const auto soon = [&](const FetchPurpose& p) {
    const auto end = needs.size() > 1 ? keep.end() : keep.begin() + long(std::min(kSoonGops, keep.size()));
    return !p.ofGop() || std::find(keep.begin(), end, GopKey{p.sequence, p.gop}) != end;
  };
  bool urgent = false;
  fetches_.forEach([&](Fetch& fetch) {
    fetch.purpose.ahead = fetch.purpose.ahead && !needed(fetch.purpose);
    urgent = urgent || (!fetch.purpose.ahead && soon(fetch.purpose));
  });
  if (!urgent) return;
  fetches_.cancel([&](const FetchPurpose& purpose) {
    if (!purpose.ahead) return false;
    if (PartState* state = stateOf(purpose)) *state = PartState::Absent;
    return true;
  });
}

// Beginnings stay as long as they fit into the budget beside what is needed.
void Loading::keepAhead(std::vector<GopKey>& keep) {
  needed_bytes_ = bytesOf(keep);
  if (needed_bytes_ + bytesOf(ahead_) <= budget_bytes_) keep.insert(keep.end(), ahead_.begin(), ahead_.end());
}

}  // namespace fourdvt

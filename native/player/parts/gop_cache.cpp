// SPDX-License-Identifier: Apache-2.0
#include "player/parts/gop_cache.h"

#include <algorithm>

namespace fourdvt {

Gop& GopCache::touch(GopKey key) {
  Gop& gop = gops_[key];
  gop.last_use = ++uses_;
  return gop;
}

const Gop* GopCache::find(GopKey key) const {
  const auto it = gops_.find(key);
  return it == gops_.end() ? nullptr : &it->second;
}

Gop* GopCache::find(GopKey key) {
  auto it = gops_.find(key);
  return it == gops_.end() ? nullptr : &it->second;
}

template <class MayGo>
GopCache::Entry GopCache::oldest(const MayGo& may_go) {
  Entry found = gops_.end();
  for (Entry it = gops_.begin(); it != gops_.end(); ++it)
    if (may_go(*it) && (found == gops_.end() || it->second.last_use < found->second.last_use)) found = it;
  return found;
}

void GopCache::trim(const std::vector<GopKey>& keep) {
  const auto kept = [&](const GopKey& key) { return std::find(keep.begin(), keep.end(), key) != keep.end(); };
  for (uint64_t total = decodedBytes(); total > decoded_budget_bytes_;) {
    const Entry it = oldest([&](const auto& entry) { return entry.second.decoded() && !kept(entry.first); });
    if (it == gops_.end()) break;
    total -= it->second.decodedBytes();
    it->second.dropDecoded();
  }
  for (uint64_t total = encodedBytes(); total > encoded_budget_bytes_;) {
    const Entry it = oldest([&](const auto& entry) {
      const Gop& gop = entry.second;
      return !kept(entry.first) && gop.video_state != PartState::Fetching && gop.chunk_state != PartState::Fetching &&
             gop.better_state != PartState::Fetching && gop.fine_state != PartState::Fetching;
    });
    if (it == gops_.end()) break;
    total -= it->second.encodedBytes();
    gops_.erase(it);
  }
}

void GopCache::dropSequence(int sequence) {
  for (auto it = gops_.begin(); it != gops_.end();) it = it->first.sequence == sequence ? gops_.erase(it) : ++it;
}

uint64_t GopCache::encodedBytes() const {
  uint64_t total = 0;
  for (const auto& [key, gop] : gops_) total += gop.encodedBytes();
  return total;
}

uint64_t GopCache::decodedBytes() const {
  uint64_t total = 0;
  for (const auto& [key, gop] : gops_) total += gop.decodedBytes();
  return total;
}

size_t GopCache::decodedCount() const {
  return static_cast<size_t>(
      std::count_if(gops_.begin(), gops_.end(), [](const auto& entry) { return entry.second.decoded(); }));
}

std::vector<uint32_t> neededGops(const package::StreamIndex& index, uint32_t frame, bool loop, uint32_t ahead) {
  std::vector<uint32_t> gops{index.chunkOfFrame(frame)};
  const auto count = static_cast<uint32_t>(index.chunks.size());
  const package::ChunkEntry& own = index.chunks[gops[0]];
  for (uint32_t held = own.first_frame + own.frame_count - frame; gops.size() < 2 || held < ahead;) {
    uint32_t next = gops.back() + 1;
    if (next == count) {
      if (!loop) break;
      next = 0;
    }
    if (std::find(gops.begin(), gops.end(), next) != gops.end()) break;
    gops.push_back(next);
    held += index.chunks[next].frame_count;
  }
  return gops;
}

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
#include "stream/gop_cache.h"

#include <algorithm>

namespace fourdvt::stream {

Gop& GopCache::touch(GopKey key) {
  Gop& gop = gops_[key];
  gop.last_use = ++uses_;
  return gop;
}

Gop* GopCache::find(GopKey key) {
  auto it = gops_.find(key);
  return it == gops_.end() ? nullptr : &it->second;
}

void GopCache::trim(const std::vector<GopKey>& keep) {
  auto kept = [&](const GopKey& key) { return std::find(keep.begin(), keep.end(), key) != keep.end(); };
  for (auto& [key, gop] : gops_)
    if (!kept(key)) gop.geometry.reset();
  uint64_t total = encodedBytes();
  while (total > budget_bytes_) {
    auto oldest = gops_.end();
    for (auto it = gops_.begin(); it != gops_.end(); ++it) {
      const bool fetching =
          it->second.video_state == PartState::Fetching || it->second.chunk_state == PartState::Fetching;
      if (kept(it->first) || fetching) continue;
      if (oldest == gops_.end() || it->second.last_use < oldest->second.last_use) oldest = it;
    }
    if (oldest == gops_.end()) return;
    total -= oldest->second.encodedBytes();
    gops_.erase(oldest);
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

size_t GopCache::decodedCount() const {
  return static_cast<size_t>(
      std::count_if(gops_.begin(), gops_.end(), [](const auto& entry) { return entry.second.geometry != nullptr; }));
}

std::vector<uint32_t> neededGops(const package::StreamIndex& index, uint32_t frame, bool loop, uint32_t ahead) {
  std::vector<uint32_t> gops{index.chunkOfFrame(frame)};
  const auto count = static_cast<uint32_t>(index.chunks.size());
  for (uint32_t i = 0; i < ahead; ++i) {
    uint32_t next = gops.back() + 1;
    if (next == count) {
      if (!loop) break;
      next = 0;
    }
    if (std::find(gops.begin(), gops.end(), next) != gops.end()) break;
    gops.push_back(next);
  }
  return gops;
}

}  // namespace fourdvt::stream

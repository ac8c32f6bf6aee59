// SPDX-License-Identifier: Apache-2.0
#include "player/parts/fetches.h"

#include <algorithm>

namespace fourdvt {

namespace {
constexpr int kTries = 3;
}  // namespace

void Fetches::request(Fetch fetch) {
  const uint32_t id = next_id_++;
  fetch.range.id = id;
  if (!progress_ended_ && fetch.sequence >= 0) progress_total_ += fetch.range.bytes;
  outbox_.request(fetch.range);
  fetches_[id] = std::move(fetch);
}

const Fetch* Fetches::find(uint32_t id) const {
  const auto it = fetches_.find(id);
  return it == fetches_.end() ? nullptr : &it->second;
}

Fetch Fetches::finish(uint32_t id) {
  const auto it = fetches_.find(id);
  Fetch fetch = std::move(it->second);
  fetches_.erase(it);
  bytes_fetched_ += fetch.range.bytes;
  if (progress_ended_) return fetch;
  progress_loaded_ += fetch.range.bytes;
  outbox_.emit({EventKind::Progress, {}, progress_loaded_, std::max(progress_total_, progress_loaded_)});
  return fetch;
}

std::optional<Fetch> Fetches::fail(uint32_t id) {
  const auto it = fetches_.find(id);
  if (it == fetches_.end()) return std::nullopt;
  if (it->second.tries < kTries) {
    ++it->second.tries;
    outbox_.request(it->second.range);
    return std::nullopt;
  }
  Fetch fetch = std::move(it->second);
  fetches_.erase(it);
  return fetch;
}

}  // namespace fourdvt

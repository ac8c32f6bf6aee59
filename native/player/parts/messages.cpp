// SPDX-License-Identifier: Apache-2.0
#include "player/parts/messages.h"

#include <algorithm>

namespace fourdvt {
const char* eventName(EventKind kind) {
  switch (kind) {
    case EventKind::LoadedMetadata:
      return "loadedmetadata";
    case EventKind::CanPlay:
      return "canplay";
    case EventKind::Playing:
      return "playing";
    case EventKind::Paused:
      return "pause";
    case EventKind::Waiting:
      return "waiting";
    case EventKind::Seeked:
      return "seeked";
    case EventKind::Ended:
      return "ended";
    case EventKind::TimeUpdate:
      return "timeupdate";
    case EventKind::Progress:
      return "progress";
    case EventKind::SequenceChanged:
      return "sequencechange";
    case EventKind::Error:
      return "error";
    case EventKind::Warning:
      return "warning";
    case EventKind::TransitionStarted:
      return "transitionstart";
    case EventKind::TransitionEnded:
      return "transitionend";
    case EventKind::Sharper:
      return "sharper";
  }
  return "error";
}

void Fetches::request(const FetchPurpose& purpose, const std::string& uri, uint64_t offset, uint64_t bytes) {
  if (!progress_ended_ && purpose.sequence >= 0) progress_total_ += bytes;
  Fetch& fetch = fetches_.emplace_back();
  fetch.purpose = purpose;
  fetch.range = {next_id_++, uri, offset, bytes};
  outbox_.request(fetch.range);
}

std::vector<Fetch>::iterator Fetches::locate(uint32_t id) {
  return std::find_if(fetches_.begin(), fetches_.end(), [id](const Fetch& f) { return f.range.id == id; });
}

const Fetch* Fetches::find(uint32_t id) const {
  const auto found = const_cast<Fetches*>(this)->locate(id);
  return found == fetches_.end() ? nullptr : &*found;
}

FetchPurpose Fetches::finish(uint32_t id) {
  const auto fetch = locate(id);
  const FetchPurpose purpose = fetch->purpose;
  const uint64_t bytes = fetch->range.bytes;
  fetches_.erase(fetch);
  bytes_fetched_ += bytes;
  if (progress_ended_) return purpose;
  progress_loaded_ += bytes;
  outbox_.emit({EventKind::Progress, {}, progress_loaded_, std::max(progress_total_, progress_loaded_)});
  return purpose;
}

Fetch Fetches::drop(uint32_t id) {
  const auto fetch = locate(id);
  Fetch dropped = std::move(*fetch);
  fetches_.erase(fetch);
  return dropped;
}

}  // namespace fourdvt

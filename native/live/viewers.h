// SPDX-License-Identifier: Apache-2.0
// Connected viewers. A viewer receives the manifest, then frames starting with a key. A slow viewer skips frames until
// the next key, so that its queue stays bounded and others are unaffected. Functions may be called on any thread.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "live/net/websocket.h"

namespace fourdvt::live {

struct ViewerStatus {
  uint64_t viewers = 0, frames_skipped = 0;  // skipped: total of all viewers since the start
  double bytes_per_s = 0;                    // total over all viewers
};

class Viewers {
 public:
  static constexpr size_t kMaxBehindMessages = 2, kMaxBehindBytes = 96 << 10;

  void add(const std::shared_ptr<Connection>& connection, const std::string& manifest);
  void remove(const std::shared_ptr<Connection>& connection);
  void send(const Bytes& frame, bool key);
  ViewerStatus status();

 private:
  using Clock = std::chrono::steady_clock;
  struct Viewer {
    bool waits_for_key = true;
    bool has_had_frames = false;
  };

  std::mutex mutex_;
  std::map<std::shared_ptr<Connection>, Viewer> viewers_;
  uint64_t frames_skipped_ = 0, bytes_ = 0;
  double bytes_per_s_ = 0;
  Clock::time_point measured_ = Clock::now();
};

}  // namespace fourdvt::live

// SPDX-License-Identifier: Apache-2.0
// The pages that look: each gets the manifest, then frames from a key on. One
// that cannot take them as they come skips to the next key, and slows no other.
// All functions may be called on any thread.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>

#include "live/net/websocket.h"

namespace fourdvt::live {

class Viewers {
 public:
  static constexpr size_t kMostWaiting = 2;               // frames that a viewer may be behind
  static constexpr size_t kMostWaitingBytes = 96u << 10;  // and bytes

  void add(const std::shared_ptr<Connection>& connection, const std::string& manifest);
  void remove(const Connection* connection);
  void send(const Bytes& frame, bool key);
  void close();  // nothing is sent any more

  struct Status {
    uint64_t viewers = 0, skipped = 0;
    double bytes_per_s = 0;  // over the last second or two
  };
  Status status() const;

 private:
  struct Viewer {
    std::shared_ptr<Connection> connection;
    bool needs_key = true;
  };
  using Clock = std::chrono::steady_clock;
  mutable std::mutex mutex_;
  std::map<const Connection*, Viewer> viewers_;
  uint64_t skipped_ = 0, bytes_ = 0, bytes_before_ = 0;
  Clock::time_point since_ = Clock::now();
  double bytes_per_s_ = 0;
  bool closed_ = false;
};

}  // namespace fourdvt::live

// SPDX-License-Identifier: Apache-2.0
// The connections of camera processes: who each one is, questions about its clock, its settings. Reads every message,
// and says which connection to close. Does NOT check tokens.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "live/net/websocket.h"
#include "live/server/pipeline.h"

namespace fourdvt::live {

class Cameras {
 public:
  // rig, pipeline: borrowed. is_local: of each of the rig's cameras, that this process reads it itself.
  Cameras(const Rig& rig, Pipeline& pipeline, std::vector<bool> is_local, double hello_s);

  // On the server's thread.
  void add(const std::shared_ptr<Connection>& connection);
  void remove(const std::shared_ptr<Connection>& connection);
  // Errors: for what the connection is to be closed.
  Status receive(const std::shared_ptr<Connection>& connection, std::span<const uint8_t> bytes, bool text);
  // Every fifth of a second.
  void tick();

  void set(size_t camera, const CameraSettings& settings);  // on any thread

 private:
  struct Peer {
    int camera = -1;  // in the rig; -1: no Hello yet
    int ticks = 0;    // since it was opened, or since its Hello
  };

  Status hello(const std::shared_ptr<Connection>& connection, Peer& peer, const Hello& hello);

  const Rig& rig_;
  Pipeline& pipeline_;
  const std::vector<bool> is_local_;
  const double hello_s_;
  std::map<std::shared_ptr<Connection>, Peer> peers_;
  std::mutex mutex_;
  std::vector<std::shared_ptr<Connection>> by_camera_;  // guarded by the mutex
};

}  // namespace fourdvt::live

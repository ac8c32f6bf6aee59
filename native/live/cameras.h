// SPDX-License-Identifier: Apache-2.0
// Connections of camera processes: identification, clock synchronisation, settings. Parses every message and reports
// which connection to close. Tokens are checked in access.h.
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
  // rig, pipeline: borrowed. is_local: per camera of the rig, true if this process reads it itself.
  Cameras(const Rig& rig, Pipeline& pipeline, std::vector<bool> is_local, double hello_s);

  // Called on the server's thread, as are receive() and tick().
  void add(const std::shared_ptr<Connection>& connection);
  void remove(const std::shared_ptr<Connection>& connection);
  // Handles one message. Errors: the reason for closing the connection.
  Status receive(const std::shared_ptr<Connection>& connection, std::span<const uint8_t> bytes, bool text);
  // Called five times per second.
  void tick();

  void set(size_t camera, const CameraSettings& settings);  // callable on any thread

 private:
  struct Peer {
    int camera = -1;  // index in the rig; -1: no Hello yet
    int ticks = 0;    // ticks since the connection opened, or since its Hello
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

// SPDX-License-Identifier: Apache-2.0
// State shared by the server's connections: handler, options and the register of connections; and one connection until
// it becomes a WebSocket (http_session.cpp).
#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "live/net/asio.h"
#include "live/net/pump.h"
#include "live/net/websocket.h"

namespace fourdvt::live {

class Closable {
 public:
  virtual ~Closable() = default;
  virtual void stop() = 0;  // called on the server's thread
};

struct ServerCore {
  std::shared_ptr<asio::io_context> io = std::make_shared<asio::io_context>(1);
  ServerOptions options;
  ServerHandler* handler = nullptr;
  std::unique_ptr<asio::ssl::context> tls;  // null: plain
  std::mutex mutex;
  std::map<uint64_t, std::weak_ptr<Closable>> connections;
  uint64_t next_id = 0;
};

// Entry in the register of connections, for the object's lifetime.
class Slot {
 public:
  explicit Slot(std::shared_ptr<ServerCore> core) : core_(std::move(core)) {
    const std::lock_guard lock(core_->mutex);
    id_ = core_->next_id++;
    core_->connections[id_];
  }
  ~Slot() {
    const std::lock_guard lock(core_->mutex);
    core_->connections.erase(id_);
  }
  void setOwner(std::weak_ptr<Closable> owner) {
    const std::lock_guard lock(core_->mutex);
    core_->connections[id_] = std::move(owner);
  }

 private:
  const std::shared_ptr<ServerCore> core_;
  uint64_t id_ = 0;
};

// Starts a connection: TLS, sequential requests, answers with files in pieces. Access is decided by the handler.
// is_full: every request is answered with 503.
void startHttpSession(std::shared_ptr<ServerCore> core, std::shared_ptr<Wire> wire, bool is_full);

}  // namespace fourdvt::live

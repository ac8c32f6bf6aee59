// SPDX-License-Identifier: Apache-2.0
// WebSocket and HTTP over Boost.Beast, with optional TLS: a server for cameras and pages, a client for cameras. Bounds
// incoming messages (sizes, rates, handshake time) and outgoing queues. Messages are opaque bytes.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace fourdvt::live {

using Bytes = std::shared_ptr<const std::vector<uint8_t>>;  // shared by all connections that send it

struct HttpRequest {
  std::string path;                          // percent-decoded, begins with "/"; no query
  std::map<std::string, std::string> query;  // percent-decoded
  std::string host, origin;                  // headers "Host" and "Origin"; empty: absent
  std::string token;                         // from "Authorization: Bearer …", or else query "token"; empty: none
  std::string peer;                          // address and port, shown on the console
};

struct HttpAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8", body;
  std::string file;          // path of a local file, sent instead of `body` with support for byte ranges
  std::string location;      // target of a redirection; empty: none
  std::string allow_origin;  // origin whose pages may read the answer, besides the server's own; empty: none
};

// One WebSocket of the server. All functions may be called on any thread.
class Connection {
 public:
  virtual ~Connection() = default;
  virtual const HttpRequest& request() const = 0;           // request that opened it
  virtual void send(Bytes message, bool text = false) = 0;  // queues a message; messages are sent in order
  virtual size_t queuedBytes() const = 0;                   // bytes not yet accepted by the operating system
  virtual size_t queuedMessages() const = 0;                // messages not yet accepted by the operating system
  // Sends what is queued, then closes. onMessage is not called after this; onClose is called within 2 s.
  virtual void close(uint16_t code, const std::string& reason) = 0;
};

struct SocketLimits {
  size_t max_message_bytes = 4096;
  double max_messages_per_s = 20;       // includes pings; average over two seconds; the connection closes above it
  size_t max_queued_bytes = 16u << 20;  // the connection closes above it
};

// Callbacks of the server's one thread; each must return soon.
class ServerHandler {
 public:
  virtual ~ServerHandler() = default;
  virtual HttpAnswer onGet(const HttpRequest& request) = 0;
  // Returns the limits of a WebSocket that requests to open, or an error and an HTTP status to refuse it.
  virtual Result<SocketLimits> onOpening(const HttpRequest& request, int& refused_status) = 0;
  virtual void onOpen(const std::shared_ptr<Connection>& connection) = 0;
  virtual void onMessage(const std::shared_ptr<Connection>& connection, std::span<const uint8_t> bytes, bool text) = 0;
  virtual void onClose(const std::shared_ptr<Connection>& connection) = 0;
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  uint16_t port = 0;                       // 0: any free port
  std::string certificate_file, key_file;  // PEM; TLS if both are set
  int max_connections = 256;
  int socket_send_bytes = 64 << 10;  // size of the system's send buffer: minimum backlog of a slow peer
  double handshake_s = 10;           // timeout of the TLS handshake, and of reading a request
  double idle_s = 20;                // timeout of a ping's answer, after which a WebSocket closes
};

class Server {
 public:
  // Listens immediately, on a thread of its own. `handler` outlives the server. Errors: InvalidArgument (address, port
  // in use; with the remedy), FileUnreadable (certificate or key).
  static Result<std::unique_ptr<Server>> start(const ServerOptions& options, ServerHandler& handler);
  virtual ~Server() = default;  // closes all connections, joins the thread
  virtual uint16_t port() const = 0;
  // Runs `action` on the server's thread every `period_s` until the server is destroyed.
  virtual void every(double period_s, std::function<void()> action) = 0;
};

struct ClientOptions {
  std::string url;             // ws://host:port/path or wss://…
  std::string token;           // sent as "Authorization: Bearer …"; empty: none
  std::string ca_file;         // PEM of a certificate to trust besides the system's, for wss
  double longest_pause_s = 2;  // limit of the growing pause between connection attempts
  size_t max_message_bytes = 16u << 20;
};

// Close codes by which a server refuses a client permanently.
constexpr uint16_t kFirstRefusal = 4400, kLastRefusal = 4499;

// Callbacks, on the client's thread.
struct ClientEvents {
  std::function<void()> on_open;
  std::function<void(std::span<const uint8_t>, bool text)> on_message;
  // Called after a loss and after a failed attempt. refused: by a status of 400 to 499 or a close code from
  // kFirstRefusal to kLastRefusal; the client then stops retrying.
  std::function<void(const std::string& reason, bool refused)> on_close;
};

// WebSocket client that reconnects after every loss.
class Client {
 public:
  // Errors: InvalidArgument (url), FileUnreadable (ca_file).
  static Result<std::unique_ptr<Client>> start(const ClientOptions& options, ClientEvents events);
  virtual ~Client() = default;  // closes, joins the thread
  virtual bool open() const = 0;
  virtual void send(Bytes message, bool text = false) = 0;  // drops the message unless the connection is open
  virtual size_t queuedBytes() const = 0;
  virtual size_t queuedMessages() const = 0;
};

}  // namespace fourdvt::live

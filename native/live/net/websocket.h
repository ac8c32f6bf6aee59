// SPDX-License-Identifier: Apache-2.0
// WebSocket and HTTP over Boost.Beast, with TLS where asked for: a server for cameras and pages, a client for cameras.
// Bounds what peers send (sizes, rates, time to shake hands) and what waits for them. Does NOT interpret messages.
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
  std::string host, origin;                  // headers; empty: none
  std::string token;                         // "Authorization: Bearer …", or else query "token"; empty: none
  std::string peer;                          // address and port, for the console
};

struct HttpAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8", body;
  std::string file;          // sent instead of `body`, with byte ranges; a path on this machine
  std::string location;      // of a redirection; empty: none
  std::string allow_origin;  // whose pages may read the answer besides the server's own; empty: none
};

// One WebSocket of the server. All functions may be called on any thread.
class Connection {
 public:
  virtual ~Connection() = default;
  virtual const HttpRequest& request() const = 0;           // it was opened with
  virtual void send(Bytes message, bool text = false) = 0;  // queued, in order
  virtual size_t queuedBytes() const = 0;                   // that the system has not taken yet
  virtual size_t queuedMessages() const = 0;                // the same, counted
  // Sends what is queued, then closes. onMessage is not called any more; onClose is, at the latest 2 s later.
  virtual void close(uint16_t code, const std::string& reason) = 0;
};

struct SocketLimits {
  size_t most_message_bytes = 4096;
  double most_messages_per_s = 20;       // pings too; on average over two seconds; beyond it the connection is closed
  size_t most_queued_bytes = 16u << 20;  // beyond it the connection is closed
};

// Called on the server's one thread; must return soon.
class ServerHandler {
 public:
  virtual ~ServerHandler() = default;
  virtual HttpAnswer onGet(const HttpRequest& request) = 0;
  // Limits of a WebSocket that wants to open; or status and reason why it may not.
  virtual Result<SocketLimits> onOpening(const HttpRequest& request, int& refused_status) = 0;
  virtual void onOpen(const std::shared_ptr<Connection>& connection) = 0;
  virtual void onMessage(const std::shared_ptr<Connection>& connection, std::span<const uint8_t> bytes, bool text) = 0;
  virtual void onClose(const std::shared_ptr<Connection>& connection) = 0;
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  uint16_t port = 0;                       // 0: any
  std::string certificate_file, key_file;  // PEM; both: TLS
  int most_connections = 256;
  int socket_send_bytes = 64 << 10;  // of the system's buffer: what a slow peer is behind at least
  double handshake_s = 10;           // for TLS, and again for a request
  double idle_s = 20;                // a WebSocket that answers no ping for so long is closed
};

class Server {
 public:
  // Listens at once, on a thread of its own. `handler` outlives it. Errors: InvalidArgument (address, port in use;
  // with the remedy), FileUnreadable (certificate or key).
  static Result<std::unique_ptr<Server>> start(const ServerOptions& options, ServerHandler& handler);
  virtual ~Server() = default;  // closes all connections, joins the thread
  virtual uint16_t port() const = 0;
  // Runs `action` on the server's thread every `period_s`, until the server is destroyed.
  virtual void every(double period_s, std::function<void()> action) = 0;
};

struct ClientOptions {
  std::string url;             // ws://host:port/path or wss://…
  std::string token;           // sent as "Authorization: Bearer …"; empty: none
  std::string ca_file;         // PEM of a certificate to trust besides the system's; for wss
  double longest_pause_s = 2;  // between attempts to connect, which grow up to it
  size_t most_message_bytes = 16u << 20;
};

// Close codes by which a server refuses a client for good.
constexpr uint16_t kFirstRefusal = 4400, kLastRefusal = 4499;

// Called on the client's thread.
struct ClientEvents {
  std::function<void()> on_open;
  std::function<void(std::span<const uint8_t>, bool text)> on_message;
  // After a loss, and after an attempt that failed. refused: by a status of 400 to 499 or a close code from
  // kFirstRefusal to kLastRefusal; the client does not try again.
  std::function<void(const std::string& reason, bool refused)> on_close;
};

// Connects, and after a loss again and again.
class Client {
 public:
  // Errors: InvalidArgument (url), FileUnreadable (ca_file).
  static Result<std::unique_ptr<Client>> start(const ClientOptions& options, ClientEvents events);
  virtual ~Client() = default;  // closes, joins the thread
  virtual bool open() const = 0;
  virtual void send(Bytes message, bool text = false) = 0;  // dropped while it is not open
  virtual size_t queuedBytes() const = 0;
  virtual size_t queuedMessages() const = 0;
};

}  // namespace fourdvt::live

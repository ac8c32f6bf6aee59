// SPDX-License-Identifier: Apache-2.0
// A TCP connection (Wire) and a WebSocket of either side on top of it (Pump): handshake, reading within limits, a write
// queue of shared buffers, closing. The caller connects the socket.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "live/net/asio.h"
#include "live/net/websocket.h"

namespace fourdvt::live {
using WireDone = std::function<void(ErrorCode, size_t)>;

// A TCP connection, plain or within TLS, as one type, so that HTTP and WebSocket are compiled once. Closes when a step
// exceeds its timeout. All functions are called on the thread that runs the io_context; done() is called there, never
// from within them.
class Wire {
 public:
  virtual ~Wire() = default;
  // tls: borrowed; null: plain.
  static std::shared_ptr<Wire> create(asio::ip::tcp::socket socket, asio::ssl::context* tls);

  virtual asio::ip::tcp::socket& socket() = 0;
  virtual bool isSecure() const = 0;
  // Performs the client's handshake; `host`: name that the certificate must match.
  virtual void shakeHandsAsClient(const std::string& host, std::function<void(ErrorCode)> done) = 0;
  virtual void shakeHandsAsServer(std::function<void(ErrorCode)> done) = 0;
  virtual void readSome(asio::mutable_buffer into, WireDone done) = 0;
  virtual void writeSome(const std::vector<asio::const_buffer>& parts, WireDone done) = 0;
  virtual void writeAll(asio::const_buffer bytes, WireDone done) = 0;
  // Ends the sending side and waits until the peer has ended its own.
  virtual void end(std::function<void()> done) = 0;
  virtual void close() = 0;  // immediate; pending operations fail
  virtual void expireAfter(double seconds) = 0;
  virtual void expireNever() = 0;
};

// Callbacks, on the thread that runs the io_context.
struct PumpEvents {
  std::function<void(std::span<const uint8_t>, bool text)> on_message;   // not called after close()
  std::function<void(uint16_t code, const std::string& reason)> on_end;  // called once; code 0: lost without a close
};

constexpr double kCloseSeconds = 2;  // timeout of the peer's answer to a close

class Pump {
 public:
  virtual ~Pump() = default;
  static std::shared_ptr<Pump> create(std::shared_ptr<asio::io_context> io, std::shared_ptr<Wire> wire,
                                      double handshake_s, double idle_s);
  // request: bytes as received, including the empty line at its end.
  virtual void accept(const std::string& request, std::function<void(bool ok)> done) = 0;
  struct Answer {
    bool ok = false;
    unsigned status = 0;  // status of an HTTP answer that refuses; 0: none received
    std::string reason;
  };
  virtual void shakeHands(const std::string& authority, const std::string& target, const std::string& token,
                          std::function<void(const Answer&)> done) = 0;
  // Starts reading and writing after the handshake.
  virtual void run(const SocketLimits& limits, PumpEvents events) = 0;

  // Callable on any thread.
  virtual void send(Bytes message, bool text) = 0;
  // Sends what is queued, then closes; cuts the connection if the peer does not respond.
  virtual void close(uint16_t code, const std::string& reason) = 0;
  size_t queuedBytes() const { return queued_bytes_; }
  size_t queuedMessages() const { return queued_messages_; }

 protected:
  std::atomic<size_t> queued_bytes_{0}, queued_messages_{0};
};

}  // namespace fourdvt::live

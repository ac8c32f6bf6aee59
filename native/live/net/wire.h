// SPDX-License-Identifier: Apache-2.0
// A TCP connection, plain or within TLS, as one type, so that HTTP and WebSocket are compiled once. Ends by itself when
// a step takes longer than allowed. Does NOT connect, and does NOT interpret bytes.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "live/net/asio.h"

namespace fourdvt::live {

using WireDone = std::function<void(ErrorCode, size_t)>;

// All functions are called on the thread that runs the io_context; done() is called there, never from within them.
class Wire {
 public:
  virtual ~Wire() = default;
  // tls: borrowed; none: plain.
  static std::shared_ptr<Wire> create(asio::ip::tcp::socket socket, asio::ssl::context* tls);

  virtual asio::ip::tcp::socket& socket() = 0;
  virtual bool isSecure() const = 0;
  // Opens the client's side; `host`: whose certificate is accepted.
  virtual void shakeHandsAsClient(const std::string& host, std::function<void(ErrorCode)> done) = 0;
  virtual void shakeHandsAsServer(std::function<void(ErrorCode)> done) = 0;
  virtual void readSome(asio::mutable_buffer into, WireDone done) = 0;
  virtual void writeSome(const std::vector<asio::const_buffer>& parts, WireDone done) = 0;
  virtual void writeAll(asio::const_buffer bytes, WireDone done) = 0;
  // Ends the sending side, and waits until the peer has ended its own.
  virtual void end(std::function<void()> done) = 0;
  virtual void close() = 0;  // at once; what is under way fails
  virtual void expireAfter(double seconds) = 0;
  virtual void expireNever() = 0;
};

}  // namespace fourdvt::live

// SPDX-License-Identifier: Apache-2.0
#include "live/net/wire.h"

#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/write.hpp>
#include <optional>

namespace fourdvt::live {
namespace {

using asio::ip::tcp;

constexpr size_t kMostRecordBytes = 16 << 10;  // of TLS
constexpr int kMostDrained = 16;               // reads, until a peer's end is not waited for any more

class SocketWire final : public Wire, public std::enable_shared_from_this<SocketWire> {
  // A handler that keeps the connection until it has run.
  template <class... A>
  auto keeping(std::function<void(ErrorCode, A...)> done) {
    return [self = shared_from_this(), done = std::move(done)](ErrorCode error, A... count) { done(error, count...); };
  }

 public:
  SocketWire(tcp::socket socket, asio::ssl::context* tls) : socket_(std::move(socket)), timer_(socket_.get_executor()) {
    if (tls) tls_.emplace(socket_, *tls);
  }

  tcp::socket& socket() override { return socket_; }
  bool isSecure() const override { return tls_.has_value(); }

  void shakeHandsAsClient(const std::string& host, std::function<void(ErrorCode)> done) override {
    ErrorCode is_name;
    asio::ip::make_address(host, is_name);
    if (is_name) SSL_set_tlsext_host_name(tls_->native_handle(), host.c_str());
    tls_->set_verify_callback(asio::ssl::host_name_verification(host), is_name);
    tls_->async_handshake(asio::ssl::stream_base::client, keeping(std::move(done)));
  }

  void shakeHandsAsServer(std::function<void(ErrorCode)> done) override {
    tls_->async_handshake(asio::ssl::stream_base::server, keeping(std::move(done)));
  }

  void readSome(asio::mutable_buffer into, WireDone done) override {
    if (tls_)
      tls_->async_read_some(into, keeping(std::move(done)));
    else
      socket_.async_read_some(into, keeping(std::move(done)));
  }

  void writeSome(const std::vector<asio::const_buffer>& parts, WireDone done) override {
    if (!tls_) return socket_.async_write_some(parts, keeping(std::move(done)));
    record_.clear();  // one record, where each part would become one
    for (const asio::const_buffer& part : parts) {
      const auto* bytes = static_cast<const uint8_t*>(part.data());
      record_.insert(record_.end(), bytes, bytes + std::min(part.size(), kMostRecordBytes - record_.size()));
    }
    tls_->async_write_some(asio::const_buffer(asio::buffer(record_)), keeping(std::move(done)));
  }

  void writeAll(asio::const_buffer bytes, WireDone done) override {
    if (tls_)
      asio::async_write(*tls_, bytes, keeping(std::move(done)));
    else
      asio::async_write(socket_, bytes, keeping(std::move(done)));
  }

  void end(std::function<void()> done) override {
    if (tls_) {
      tls_->async_shutdown([self = shared_from_this(), done = std::move(done)](ErrorCode) { done(); });
      return;
    }
    ErrorCode ignored;
    socket_.shutdown(tcp::socket::shutdown_send, ignored);
    record_.resize(kMostRecordBytes);
    drain(kMostDrained, std::move(done));
  }

  void close() override {
    timer_.cancel();
    ErrorCode ignored;
    socket_.close(ignored);
  }

  void expireAfter(double seconds) override {
    timer_.expires_after(milliseconds(seconds));
    timer_.async_wait([weak = weak_from_this()](ErrorCode error) {
      if (const auto self = weak.lock(); !error && self) self->close();
    });
  }

  void expireNever() override { timer_.cancel(); }

 private:
  void drain(int pieces, std::function<void()> done) {
    readSome(asio::buffer(record_), [this, pieces, done = std::move(done)](ErrorCode error, size_t) {
      if (error || pieces == 0) return done();
      drain(pieces - 1, done);
    });
  }

  tcp::socket socket_;
  asio::steady_timer timer_;
  std::optional<asio::ssl::stream<tcp::socket&>> tls_;
  std::vector<uint8_t> record_;
};

}  // namespace

std::shared_ptr<Wire> Wire::create(tcp::socket socket, asio::ssl::context* tls) {
  return std::make_shared<SocketWire>(std::move(socket), tls);
}

}  // namespace fourdvt::live

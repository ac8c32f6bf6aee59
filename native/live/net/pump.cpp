// SPDX-License-Identifier: Apache-2.0
#include "live/net/pump.h"

#include <boost/asio/async_result.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <deque>
#include <optional>

#include "base/watch.h"
#include "live/net/http.h"

namespace fourdvt::live {
namespace {

namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;

// Adapts a Wire to Beast's stream concept.
class WireLayer {
 public:
  explicit WireLayer(std::shared_ptr<Wire> wire) : wire_(std::move(wire)) {}
  using executor_type = asio::ip::tcp::socket::executor_type;
  executor_type get_executor() { return wire_->socket().get_executor(); }
  Wire& wire() { return *wire_; }

  template <class Buffers, class Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    asio::mutable_buffer first;
    for (auto at = asio::buffer_sequence_begin(buffers); first.size() == 0 && at != asio::buffer_sequence_end(buffers);
         ++at)
      first = *at;
    wire_->readSome(first, shared(std::forward<Handler>(handler)));
  }

  template <class Buffers, class Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    const std::vector<asio::const_buffer> parts(asio::buffer_sequence_begin(buffers),
                                                asio::buffer_sequence_end(buffers));
    wire_->writeSome(parts, shared(std::forward<Handler>(handler)));
  }

  template <class Handler>
  void end(Handler&& handler) {
    wire_->expireAfter(kCloseSeconds);
    wire_->end([done = shared(std::forward<Handler>(handler))] { done({}, 0); });
  }

 private:
  // Shares a handler, because Beast's handlers are move-only.
  template <class Handler>
  static WireDone shared(Handler&& handler) {
    auto held = std::make_shared<std::decay_t<Handler>>(std::forward<Handler>(handler));
    return [held](ErrorCode error, size_t count) {
      if constexpr (std::is_invocable_v<std::decay_t<Handler>&, ErrorCode, size_t>)
        (*held)(error, count);
      else
        (*held)(error);
    };
  }

  std::shared_ptr<Wire> wire_;
};

void beast_close_socket(WireLayer& layer) { layer.wire().close(); }

template <class Handler>
void async_teardown(beast::role_type, WireLayer& layer, Handler&& handler) {
  layer.end(std::forward<Handler>(handler));
}

// Rate limit of messages: token bucket of two seconds.
class Allowance {
 public:
  explicit Allowance(double per_s) : per_s_(per_s), left_(2 * per_s) {}
  bool take() {
    left_ = std::min(2 * per_s_, left_ + per_s_ * watch_.lap_ms() / 1e3);
    if (left_ < 1) return false;
    left_ -= 1;
    return true;
  }

 private:
  double per_s_, left_;
  Watch watch_;
};

class BeastPump final : public Pump, public std::enable_shared_from_this<BeastPump> {
 public:
  BeastPump(std::shared_ptr<asio::io_context> io, std::shared_ptr<Wire> wire, double handshake_s, double idle_s)
      : io_(std::move(io)), wire_(std::move(wire)), deadline_(*io_) {
    ws_.emplace(wire_);
    wire_->expireNever();
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = milliseconds(handshake_s);
    timeout.idle_timeout = milliseconds(idle_s);
    timeout.keep_alive_pings = true;
    ws_->set_option(timeout);
    ws_->auto_fragment(false);
    ws_->write_buffer_bytes(64 << 10);
  }

  void accept(const std::string& request, std::function<void(bool)> done) override {
    http::request_parser<http::empty_body> parser;
    ErrorCode error;
    parser.eager(true);
    parser.put(asio::buffer(request), error);
    request_ = parser.release();
    ws_->async_accept(request_, [self = shared_from_this(), done = std::move(done)](ErrorCode error) { done(!error); });
  }

  void shakeHands(const std::string& authority, const std::string& target, const std::string& token,
                  std::function<void(const Answer&)> done) override {
    ws_->set_option(websocket::stream_base::decorator([token](websocket::request_type& request) {
      if (!token.empty()) request.set(http::field::authorization, "Bearer " + token);
    }));
    ws_->async_handshake(answer_, authority, target,
                         [self = shared_from_this(), done = std::move(done)](ErrorCode error) {
                           if (error != websocket::error::upgrade_declined) return done({!error, 0, error.message()});
                           done({false, self->answer_.result_int(), cutText(self->answer_.body(), 200)});
                         });
  }

  void run(const SocketLimits& limits, PumpEvents events) override {
    limits_ = limits;
    events_ = std::move(events);
    allowance_ = Allowance(limits.max_messages_per_s);
    ws_->read_message_max(limits.max_message_bytes);
    ws_->control_callback([this](websocket::frame_type, beast::string_view) { takeMessage(); });
    read();
  }

  void send(Bytes message, bool text) override {
    if (is_over_) return;
    ++queued_messages_;
    if ((queued_bytes_ += message->size()) > limits_.max_queued_bytes) {
      if (!is_over_.exchange(true)) asio::post(*io_, [self = shared_from_this()] { self->cut(); });
      return;
    }
    asio::post(*io_, [self = shared_from_this(), message = std::move(message), text]() mutable {
      if (self->has_ended_) return;
      self->queue_.push_back({std::move(message), text});
      self->writeNext();
    });
  }

  void close(uint16_t code, const std::string& reason) override {
    if (is_over_.exchange(true)) return;
    asio::post(*io_, [self = shared_from_this(), code, reason] {
      if (self->has_ended_) return;
      self->is_closing_ = true;
      self->closing_ = websocket::close_reason(cutText(reason, 123));
      self->closing_.code = code;
      self->deadline_.expires_after(milliseconds(kCloseSeconds));
      self->deadline_.async_wait([self](ErrorCode error) {
        if (!error) self->cut();
      });
      self->writeNext();
    });
  }

 private:
  struct Item {
    Bytes message;
    bool text;
  };

  bool takeMessage() {
    if (allowance_.take()) return true;
    close(websocket::close_code::policy_error, "too many messages");
    return false;
  }

  void read() {
    ws_->async_read(buffer_, [self = shared_from_this()](ErrorCode error, size_t) {
      if (error) return self->end(error);
      const auto data = self->buffer_.cdata();
      if (!self->is_over_ && self->takeMessage()) self->hand({static_cast<const uint8_t*>(data.data()), data.size()});
      self->buffer_.consume(data.size());
      self->read();
    });
  }

  void hand(std::span<const uint8_t> message) {
    try {
      events_.on_message(message, ws_->got_text());
    } catch (const std::exception& e) {
      close(websocket::close_code::internal_error, e.what());
    }
  }

  void writeNext() {
    if (is_writing_ || has_ended_) return;
    if (queue_.empty()) {
      if (is_closing_) sendClose();
      return;
    }
    is_writing_ = true;
    ws_->text(queue_.front().text);
    ws_->async_write(asio::buffer(*queue_.front().message), [self = shared_from_this()](ErrorCode error, size_t) {
      self->is_writing_ = false;
      if (self->has_ended_) return self->clear();
      if (error) return self->cut();
      self->queued_bytes_ -= self->queue_.front().message->size();
      --self->queued_messages_;
      self->queue_.pop_front();
      self->writeNext();
    });
  }

  void sendClose() {
    if (is_close_sent_) return;
    is_close_sent_ = true;
    ws_->async_close(closing_, [self = shared_from_this()](ErrorCode) {});
  }

  void cut() { wire_->close(); }  // makes reading end with an error

  void end(ErrorCode error) {
    has_ended_ = true;
    is_over_ = true;
    deadline_.cancel();
    cut();
    if (!is_writing_) clear();
    asio::post(*io_, [self = shared_from_this()] { self->ws_.reset(); });  // its timer would keep the io_context busy
    const bool was_closed = error == websocket::error::closed;
    const std::string text(ws_->reason().reason.data(), ws_->reason().reason.size());
    const PumpEvents events = std::exchange(events_, {});
    if (events.on_end) events.on_end(was_closed ? ws_->reason().code : 0, was_closed ? text : error.message());
  }

  void clear() {
    queue_.clear();
    queued_bytes_ = queued_messages_ = 0;
  }

  const std::shared_ptr<asio::io_context> io_;
  const std::shared_ptr<Wire> wire_;
  std::optional<websocket::stream<WireLayer, false>> ws_;
  asio::steady_timer deadline_;
  http::request<http::empty_body> request_;
  websocket::response_type answer_;
  SocketLimits limits_;
  PumpEvents events_;
  Allowance allowance_{0};
  beast::flat_buffer buffer_;
  std::deque<Item> queue_;
  websocket::close_reason closing_;
  bool is_writing_ = false, is_closing_ = false, is_close_sent_ = false, has_ended_ = false;
  std::atomic<bool> is_over_{false};  // nothing more is sent or passed on
};

}  // namespace

std::shared_ptr<Pump> Pump::create(std::shared_ptr<asio::io_context> io, std::shared_ptr<Wire> wire, double handshake_s,
                                   double idle_s) {
  return std::make_shared<BeastPump>(std::move(io), std::move(wire), handshake_s, idle_s);
}

namespace {

using asio::ip::tcp;

constexpr size_t kMaxRecordBytes = 16 << 10;  // size of a TLS record
constexpr int kMaxDrained = 16;               // maximum number of reads that await the peer's end

class SocketWire final : public Wire, public std::enable_shared_from_this<SocketWire> {
  // Wraps a handler that keeps the connection alive until it has run.
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
    record_.clear();  // merges the parts into one TLS record instead of one per part
    for (const asio::const_buffer& part : parts) {
      const auto* bytes = static_cast<const uint8_t*>(part.data());
      record_.insert(record_.end(), bytes, bytes + std::min(part.size(), kMaxRecordBytes - record_.size()));
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
    record_.resize(kMaxRecordBytes);
    drain(kMaxDrained, std::move(done));
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

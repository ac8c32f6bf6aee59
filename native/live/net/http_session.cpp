// SPDX-License-Identifier: Apache-2.0
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <optional>

#include "live/net/http.h"
#include "live/net/pump.h"
#include "live/net/server_core.h"

namespace fourdvt::live {
namespace {

namespace http = boost::beast::http;

constexpr size_t kMaxHeaderBytes = 8 << 10, kPieceBytes = 64 << 10;
constexpr double kAnswerSeconds = 30;  // timeout of each write of an answer and of the next request
constexpr uint16_t kGoingAway = 1001;

std::string peerText(const asio::ip::tcp::socket& socket) {
  ErrorCode error;
  const auto peer = socket.remote_endpoint(error);
  if (error) return "?";
  const std::string address = peer.address().to_string();
  return (peer.address().is_v6() ? "[" + address + "]" : address) + ":" + std::to_string(peer.port());
}

// WebSocket as passed to the handler.
class ServerConnection final : public Connection, public Closable {
 public:
  ServerConnection(HttpRequest request, std::shared_ptr<Pump> pump)
      : request_(std::move(request)), pump_(std::move(pump)) {}
  const HttpRequest& request() const override { return request_; }
  void send(Bytes message, bool text) override { pump_->send(std::move(message), text); }
  size_t queuedBytes() const override { return pump_->queuedBytes(); }
  size_t queuedMessages() const override { return pump_->queuedMessages(); }
  void close(uint16_t code, const std::string& reason) override { pump_->close(code, reason); }
  void stop() override { close(kGoingAway, "the server ends"); }

 private:
  const HttpRequest request_;
  const std::shared_ptr<Pump> pump_;
};

class HttpSession final : public Closable, public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(std::shared_ptr<ServerCore> core, std::shared_ptr<Wire> wire, bool is_full)
      : core_(std::move(core)),
        wire_(std::move(wire)),
        peer_(peerText(wire_->socket())),
        is_full_(is_full),
        slot_(std::make_shared<Slot>(core_)) {}

  void start() {
    slot_->setOwner(weak_from_this());
    wire_->expireAfter(core_->options.handshake_s);
    if (!wire_->isSecure()) return read(core_->options.handshake_s);
    wire_->shakeHandsAsServer([self = shared_from_this()](ErrorCode error) {
      if (!error) self->read(self->core_->options.handshake_s);
    });
  }

  void stop() override { wire_->close(); }

 private:
  void read(double seconds) {
    wire_->expireAfter(seconds);
    takeHeader();
  }

  // Answers a complete header; else reads more.
  void takeHeader() {
    const size_t end = received_.find("\r\n\r\n");
    if (end == std::string::npos ? received_.size() > kMaxHeaderBytes : end + 4 > kMaxHeaderBytes) return refuse(431);
    if (end != std::string::npos) {
      header_ = received_.substr(0, end + 4);
      received_.erase(0, end + 4);
      return take();
    }
    piece_.resize(kMaxHeaderBytes);
    wire_->readSome(asio::buffer(piece_), [self = shared_from_this()](ErrorCode error, size_t count) {
      if (error) return self->stop();
      self->received_.append(self->piece_, 0, count);
      self->takeHeader();
    });
  }

  void refuse(int status, const std::string& reason = {}) {
    is_last_ = true;
    HttpAnswer answer;
    answer.status = status;
    answer.body = reason.empty() ? statusText(status) : reason;
    write(answer, {}, false);
  }

  void take() {
    http::request_parser<http::empty_body> parser;
    parser.eager(true);
    ErrorCode error;
    parser.put(asio::buffer(header_), error);
    const auto& message = parser.get();
    if (is_full_) return refuse(503, "too many connections; try again later");
    const bool is_head = message.method() == http::verb::head;
    if (!error && message.method() != http::verb::get && !is_head) return refuse(405);
    const auto target = parseTarget({message.target().data(), message.target().size()});
    if (error || !parser.is_done() || !target) return refuse(400);
    is_last_ = !message.keep_alive();
    const auto field = [&](http::field name) { return std::string(message[name]); };
    HttpRequest request{target->path, target->query, field(http::field::host), field(http::field::origin), {}, peer_};
    request.token = bearerToken(field(http::field::authorization));
    if (const auto token = request.query.find("token"); request.token.empty() && token != request.query.end())
      request.token = token->second;
    if (isUpgrade(message)) return upgrade(std::move(request));
    write(core_->handler->onGet(request), {field(http::field::range), field(http::field::if_none_match)}, is_head);
  }

  static bool isUpgrade(const http::request<http::empty_body>& message) {
    return http::token_list(message[http::field::upgrade]).exists("websocket");
  }

  void upgrade(HttpRequest request) {
    int status = 403;
    const auto limits = core_->handler->onOpening(request, status);
    if (!limits.ok()) return refuse(status, limits.error().message);
    if (!received_.empty()) return refuse(400);  // rejects WebSocket frames sent before the handshake's answer
    const auto pump = Pump::create(core_->io, wire_, core_->options.handshake_s, core_->options.idle_s);
    const auto connection = std::make_shared<ServerConnection>(std::move(request), pump);
    slot_->setOwner(connection);
    pump->accept(header_, [self = shared_from_this(), pump, connection, limits = limits.value()](bool ok) {
      if (ok) self->open(pump, connection, limits);
    });
  }

  void open(const std::shared_ptr<Pump>& pump, const std::shared_ptr<Connection>& connection,
            const SocketLimits& limits) {
    ServerHandler* handler = core_->handler;
    PumpEvents events;
    events.on_message = [handler, connection](std::span<const uint8_t> bytes, bool text) {
      handler->onMessage(connection, bytes, text);
    };
    events.on_end = [handler, connection, slot = std::move(slot_)](uint16_t, const std::string&) mutable {
      slot.reset();
      handler->onClose(connection);
    };
    pump->run(limits, std::move(events));
    handler->onOpen(connection);
  }

  void write(const HttpAnswer& answer, const FileConditions& conditions, bool is_head) {
    auto opened = openAnswer(answer, conditions, is_last_);
    piece_ = std::move(opened.head);
    if (!is_head) piece_ += opened.body;
    file_ = std::move(opened.file);
    left_ = is_head ? 0 : opened.file_bytes;
    writePiece();
  }

  void writePiece() {
    wire_->expireAfter(kAnswerSeconds);
    wire_->writeAll(asio::buffer(piece_), [self = shared_from_this()](ErrorCode error, size_t) {
      if (error) return self->stop();
      if (self->left_ == 0) return self->is_last_ ? self->finish() : self->read(kAnswerSeconds);
      self->piece_.resize(std::min<uint64_t>(self->left_, kPieceBytes));
      if (std::fread(self->piece_.data(), 1, self->piece_.size(), self->file_.get()) != self->piece_.size())
        return self->stop();  // file has become shorter: the announced length cannot be kept
      self->left_ -= self->piece_.size();
      self->writePiece();
    });
  }

  // Closes such that the peer receives the answer even if it is still sending.
  void finish() {
    wire_->expireAfter(kCloseSeconds);
    wire_->end([self = shared_from_this()] { self->stop(); });
  }

  const std::shared_ptr<ServerCore> core_;
  const std::shared_ptr<Wire> wire_;
  const std::string peer_;
  const bool is_full_;
  std::shared_ptr<Slot> slot_;
  std::string received_, header_;  // bytes not yet consumed; header of the current request
  std::string piece_;              // buffer of the current read or write
  FileHandle file_;
  uint64_t left_ = 0;
  bool is_last_ = false;
};

}  // namespace

void startHttpSession(std::shared_ptr<ServerCore> core, std::shared_ptr<Wire> wire, bool is_full) {
  std::make_shared<HttpSession>(std::move(core), std::move(wire), is_full)->start();
}

}  // namespace fourdvt::live

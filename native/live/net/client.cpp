// SPDX-License-Identifier: Apache-2.0
#include <boost/asio/connect.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <cmath>
#include <mutex>
#include <random>
#include <thread>

#include "base/watch.h"
#include "live/net/http.h"
#include "live/net/pump.h"

namespace fourdvt::live {
namespace {

using asio::ip::tcp;

constexpr double kConnectSeconds = 10, kClientIdleSeconds = 10;
constexpr size_t kMaxClientQueuedBytes = 64u << 20;
constexpr uint16_t kNormalClose = 1000;
constexpr double kFirstPause = 0.1;  // pause before the second attempt, s; doubles with each further one
constexpr double kStable = 2;        // open time that resets the pause, s

bool isRefusal(unsigned status) { return status >= 400 && status < 500 && status != 408 && status != 429; }

// One connection attempt: resolve, connect, handshake. Yields a Pump.
class Attempt final : public std::enable_shared_from_this<Attempt> {
 public:
  struct Outcome {  // `pump`, or the reason of the failure
    std::shared_ptr<Pump> pump;
    std::string reason;
    bool refused = false;
  };
  using Done = std::function<void(const Outcome&)>;

  Attempt(std::shared_ptr<asio::io_context> io, const Url& url, const std::string& token, asio::ssl::context* tls)
      : io_(std::move(io)), resolver_(*io_), url_(url), token_(token), wire_(Wire::create(tcp::socket(*io_), tls)) {}

  void start(Done done) {
    done_ = std::move(done);
    const auto resolved = [self = shared_from_this()](ErrorCode error, const tcp::resolver::results_type& at) {
      if (error) return self->end({nullptr, "cannot find " + self->url_.host + ": " + error.message()});
      self->connect(at);
    };
    resolver_.async_resolve(url_.host, url_.port, resolved);
  }

  void stop() {
    resolver_.cancel();
    wire_->close();
  }

 private:
  void end(const Outcome& outcome) {
    if (const Done done = std::exchange(done_, {})) done(outcome);
  }

  void connect(const tcp::resolver::results_type& places) {
    wire_->expireAfter(kConnectSeconds);
    const auto connected = [self = shared_from_this()](ErrorCode error, const tcp::endpoint&) {
      if (error) return self->end({nullptr, "cannot connect to " + self->url_.authority + ": " + error.message()});
      ErrorCode ignored;
      self->wire_->socket().set_option(tcp::no_delay(true), ignored);
      self->secure();
    };
    asio::async_connect(wire_->socket(), places, connected);
  }

  void secure() {
    if (!wire_->isSecure()) return shakeHands();
    wire_->shakeHandsAsClient(url_.host, [self = shared_from_this()](ErrorCode error) {
      if (!error) return self->shakeHands();
      self->end({nullptr, "no secure connection to " + self->url_.authority + ": " + error.message()});
    });
  }

  void shakeHands() {
    const auto pump = Pump::create(io_, wire_, kConnectSeconds, kClientIdleSeconds);
    pump->shakeHands(url_.authority, url_.target, token_, [self = shared_from_this(), pump](const Pump::Answer& a) {
      const std::string& who = self->url_.authority;
      if (a.ok) return self->end({pump, {}});
      if (a.status == 0) return self->end({nullptr, who + " does not answer as a live server: " + a.reason});
      self->end({nullptr, who + " refuses: " + std::to_string(a.status) + " " + a.reason, isRefusal(a.status)});
    });
  }

  const std::shared_ptr<asio::io_context> io_;
  tcp::resolver resolver_;
  const Url url_;
  const std::string token_;
  const std::shared_ptr<Wire> wire_;
  Done done_;
};

class ClientOnThread final : public Client {
 public:
  ClientOnThread(const ClientOptions& options, Url url, std::unique_ptr<asio::ssl::context> tls, ClientEvents events)
      : options_(options), url_(std::move(url)), tls_(std::move(tls)), events_(std::move(events)), timer_(*io_) {
    asio::post(*io_, [this] { attempt(); });
    thread_ = std::thread([this] { runAll(); });
  }

  ~ClientOnThread() override {
    asio::post(*io_, [this] { stopAll(); });
    thread_.join();
  }

  bool open() const override { return pump() != nullptr; }
  void send(Bytes message, bool text) override {
    if (const auto open = pump()) open->send(std::move(message), text);
  }
  size_t queuedBytes() const override {
    const auto open = pump();
    return open ? open->queuedBytes() : 0;
  }
  size_t queuedMessages() const override {
    const auto open = pump();
    return open ? open->queuedMessages() : 0;
  }

 private:
  std::shared_ptr<Pump> pump() const {
    const std::lock_guard lock(mutex_);
    return pump_;
  }
  void setPump(std::shared_ptr<Pump> pump) {
    const std::lock_guard lock(mutex_);
    pump_ = std::move(pump);
  }

  void runAll() {
    for (bool ran = false; !ran;) {
      try {
        io_->run();
        ran = true;
      } catch (const std::exception& e) {
        lost(e.what(), false);
      }
    }
    io_->restart();
    io_->poll();
  }

  void attempt() {
    if (is_stopping_) return;
    const auto one = std::make_shared<Attempt>(io_, url_, options_.token, tls_.get());
    attempt_ = one;
    one->start([this](const Attempt::Outcome& outcome) {
      if (!outcome.pump) return lost(outcome.reason, outcome.refused);
      if (!is_stopping_) opened(outcome.pump);
    });
  }

  void opened(const std::shared_ptr<Pump>& pump) {
    since_open_ = {};
    PumpEvents events;
    events.on_message = [this](std::span<const uint8_t> bytes, bool text) {
      if (!is_stopping_ && events_.on_message) events_.on_message(bytes, text);
    };
    events.on_end = [this](uint16_t code, const std::string& reason) { ended(code, reason); };
    pump->run({options_.max_message_bytes, 1e9, kMaxClientQueuedBytes}, std::move(events));
    setPump(pump);
    if (events_.on_open) events_.on_open();
  }

  void ended(uint16_t code, const std::string& reason) {
    setPump(nullptr);
    if (since_open_.seconds() > kStable) attempts_ = 0;
    const std::string why = code == 0 ? "the connection to " + url_.authority + " is lost: " + reason
                                      : url_.authority + " closes: " + std::to_string(code) + " " + reason;
    lost(why, code >= kFirstRefusal && code <= kLastRefusal);
  }

  void lost(const std::string& reason, bool refused) {
    if (is_stopping_) return;
    if (events_.on_close) events_.on_close(reason, refused);
    if (refused) return;
    const double longest = std::min(options_.longest_pause_s, kFirstPause * std::exp2(std::min(attempts_++, 20)));
    timer_.expires_after(milliseconds(longest * std::uniform_real_distribution<double>(0.5, 1)(random_)));
    timer_.async_wait([this](ErrorCode error) {
      if (!error) attempt();
    });
  }

  void stopAll() {
    is_stopping_ = true;
    timer_.cancel();
    if (const auto attempt = attempt_.lock()) attempt->stop();
    if (const auto open = pump()) open->close(kNormalClose, "the client ends");
    work_.reset();
  }

  const ClientOptions options_;
  const Url url_;
  const std::unique_ptr<asio::ssl::context> tls_;
  const ClientEvents events_;
  const std::shared_ptr<asio::io_context> io_ = std::make_shared<asio::io_context>(1);
  asio::executor_work_guard<asio::io_context::executor_type> work_ = asio::make_work_guard(*io_);
  asio::steady_timer timer_;
  std::weak_ptr<Attempt> attempt_;
  mutable std::mutex mutex_;
  std::shared_ptr<Pump> pump_;  // null unless open
  Watch since_open_;
  std::mt19937 random_{std::random_device{}()};
  int attempts_ = 0;
  bool is_stopping_ = false;
  std::thread thread_;
};

Result<std::unique_ptr<asio::ssl::context>> openVerifying(const std::string& ca_file) {
  auto tls = std::make_unique<asio::ssl::context>(asio::ssl::context::tls_client);
  SSL_CTX_set_min_proto_version(tls->native_handle(), TLS1_2_VERSION);
  ErrorCode error, ignored;
  tls->set_default_verify_paths(ignored);
  tls->set_verify_mode(asio::ssl::verify_peer, ignored);
  if (!ca_file.empty()) tls->load_verify_file(ca_file, error);
  if (error)
    return Error{ErrorId::FileUnreadable,
                 "certificate " + ca_file + ": " + error.message() + "; give a PEM file of the server's certificate"};
  return tls;
}

}  // namespace

Result<std::unique_ptr<Client>> Client::start(const ClientOptions& options, ClientEvents events) {
  FOURDVT_ASSIGN(const Url url, parseUrl(options.url));
  std::unique_ptr<asio::ssl::context> tls;
  if (url.tls) {
    FOURDVT_ASSIGN(tls, openVerifying(options.ca_file));
  }
  return std::unique_ptr<Client>(std::make_unique<ClientOnThread>(options, url, std::move(tls), std::move(events)));
}

}  // namespace fourdvt::live

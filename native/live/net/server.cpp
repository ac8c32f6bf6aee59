// SPDX-License-Identifier: Apache-2.0
#include <list>
#include <thread>
#include <vector>

#include "live/net/server_core.h"

namespace fourdvt::live {
namespace {

using asio::ip::tcp;

constexpr size_t kMaxRefusing = 64;   // maximum number of connections that await a 503; further ones are cut
constexpr double kAcceptPause = 0.1;  // pause after a failed accept, e.g. too many open files

Result<std::unique_ptr<asio::ssl::context>> openTls(const ServerOptions& options) {
  auto tls = std::make_unique<asio::ssl::context>(asio::ssl::context::tls_server);
  SSL_CTX_set_min_proto_version(tls->native_handle(), TLS1_2_VERSION);
  SSL_CTX_set_options(tls->native_handle(), SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  ErrorCode error;
  tls->set_password_callback([](size_t, asio::ssl::context::password_purpose) { return std::string(); }, error);
  tls->use_certificate_chain_file(options.certificate_file, error);
  if (error)
    return Error{ErrorId::FileUnreadable, "certificate " + options.certificate_file + ": " + error.message() +
                                              "; give a PEM file with the certificate and those that signed it"};
  tls->use_private_key_file(options.key_file, asio::ssl::context::pem, error);
  if (error)
    return Error{ErrorId::FileUnreadable, "key " + options.key_file + ": " + error.message() +
                                              "; give the certificate's private key as PEM, without a password"};
  return tls;
}

class ServerOnThread final : public Server {
 public:
  ServerOnThread(std::shared_ptr<ServerCore> core, tcp::acceptor acceptor)
      : core_(std::move(core)),
        acceptor_(std::move(acceptor)),
        pause_(*core_->io),
        deadline_(*core_->io),
        port_(acceptor_.local_endpoint().port()) {
    accept();
    thread_ = std::thread([this] { runAll(); });
  }

  ~ServerOnThread() override {
    asio::post(*core_->io, [this] { stopAll(); });
    thread_.join();
  }

  uint16_t port() const override { return port_; }

  void every(double period_s, std::function<void()> action) override {
    asio::post(*core_->io, [this, period_s, action = std::move(action)]() mutable {
      if (is_stopping_) return;
      timers_.push_back({asio::steady_timer(*core_->io, milliseconds(period_s)), period_s, std::move(action)});
      wait(timers_.back());
    });
  }

 private:
  struct Timer {
    asio::steady_timer timer;
    double period_s;
    std::function<void()> action;
  };

  void runAll() {
    for (bool ran = false; !ran;) {
      try {
        core_->io->run();
        ran = true;
      } catch (const std::exception& e) {  // thrown by one connection's handler: ends that connection only
        std::fprintf(stderr, "fourdvt: live server: %s\n", e.what());
      }
    }
    core_->io->restart();  // runs handlers posted by other threads meanwhile
    core_->io->poll();
  }

  void wait(Timer& timer) {
    timer.timer.async_wait([this, &timer](ErrorCode error) {
      if (error || is_stopping_) return;
      timer.action();
      timer.timer.expires_at(std::max(timer.timer.expiry(), std::chrono::steady_clock::now()) +
                             milliseconds(timer.period_s));
      wait(timer);
    });
  }

  void accept() {
    acceptor_.async_accept([this](ErrorCode error, tcp::socket socket) {
      if (is_stopping_) return;
      if (!error) {
        open(std::move(socket));
        return accept();
      }
      pause_.expires_after(milliseconds(kAcceptPause));
      pause_.async_wait([this](ErrorCode) {
        if (!is_stopping_) accept();
      });
    });
  }

  void open(tcp::socket socket) {
    size_t count = 0;
    {
      const std::lock_guard lock(core_->mutex);
      count = core_->connections.size();
    }
    const size_t most = static_cast<size_t>(core_->options.max_connections);
    if (count >= most + kMaxRefusing) return;
    ErrorCode ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    socket.set_option(asio::socket_base::send_buffer_size(core_->options.socket_send_bytes), ignored);
    startHttpSession(core_, Wire::create(std::move(socket), core_->tls.get()), count >= most);
  }

  void stopAll() {
    is_stopping_ = true;
    ErrorCode ignored;
    acceptor_.close(ignored);
    pause_.cancel();
    for (Timer& timer : timers_) timer.timer.cancel();
    stopConnections();
  }

  // Stops all connections. Those that ignore closing, such as within a handshake, end in later rounds.
  void stopConnections() {
    std::vector<std::shared_ptr<Closable>> open;
    {
      const std::lock_guard lock(core_->mutex);
      for (const auto& connection : core_->connections)
        if (auto owner = connection.second.lock()) open.push_back(std::move(owner));
    }
    for (const auto& connection : open) connection->stop();
    if (open.empty()) return;
    open.clear();
    deadline_.expires_after(milliseconds(0.05));
    deadline_.async_wait([this](ErrorCode) { stopConnections(); });
  }

  const std::shared_ptr<ServerCore> core_;
  tcp::acceptor acceptor_;
  asio::steady_timer pause_, deadline_;
  const uint16_t port_;
  std::list<Timer> timers_;
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace

Result<std::unique_ptr<Server>> Server::start(const ServerOptions& options, ServerHandler& handler) {
  auto core = std::make_shared<ServerCore>();
  core->options = options;
  core->handler = &handler;
  ErrorCode error;
  const auto address = asio::ip::make_address(options.address == "localhost" ? "127.0.0.1" : options.address, error);
  if (error)
    return Error{ErrorId::InvalidArgument,
                 "\"" + options.address + "\" is not an address to listen on; give one such as 127.0.0.1 or 0.0.0.0"};
  if (!options.certificate_file.empty() || !options.key_file.empty()) {
    FOURDVT_ASSIGN(core->tls, openTls(options));
  }
  const tcp::endpoint place(address, options.port);
  tcp::acceptor acceptor(*core->io);
  acceptor.open(place.protocol(), error);
  if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(place, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error)
    return Error{ErrorId::InvalidArgument, "cannot listen on " + options.address + ", port " +
                                               std::to_string(options.port) + ": " + error.message() +
                                               "; give another --port or --listen, or end the program that has it"};
  return std::unique_ptr<Server>(std::make_unique<ServerOnThread>(std::move(core), std::move(acceptor)));
}

}  // namespace fourdvt::live

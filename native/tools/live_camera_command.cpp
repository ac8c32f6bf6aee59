// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <thread>

#include "live/camera/camera_worker.h"
#include "live/net/websocket.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/stop_signal.h"

namespace fourdvt::tools {
namespace {

constexpr size_t kMostQueued = 2;  // pictures that the network has not taken yet
constexpr const char* kTokenVariable = "FOURDVT_LIVE_TOKEN";

const CommandHelp& help() {
  static const CommandHelp text{"live-camera RIG.json --camera NAME --server URL [options]",
                                "Opens one camera of a rig, cuts the performer out of its pictures, and "
                                "sends his outlines and his part of the "
                                "pictures to fourdvt live. Connects again whenever the connection is "
                                "lost. Ends by Ctrl-C.",
                                {{"--camera", "NAME", "camera of the rig (required)"},
                                 {"--server", "URL", "ws://HOST:PORT or wss://HOST:PORT (required)"},
                                 {"--token", "TOKEN",
                                  "the server's camera token (default: the environment's "
                                  "FOURDVT_LIVE_TOKEN)"},
                                 {"--ca", "FILE", "certificate to trust, PEM: of a server that has made its own"},
                                 {"--delay-ms", "X", "sends pictures so much later, 0 to 5000; for tests (default 0)"},
                                 {"--clock-off", "S",
                                  "pretends a clock that is so many seconds ahead, -1000 to 1000; for "
                                  "tests (default 0)"}}};
  return text;
}

int64_t now_us() {
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

struct CameraOptions {
  std::string rig, camera;
  live::ClientOptions client;
  double delay_s = 0;
  int64_t clock_off_us = 0;
};

CameraOptions readOptions(Args& args) {
  CameraOptions o;
  o.rig = args.positional();
  o.camera = args.required("--camera");
  o.client.url = args.required("--server");
  while (o.client.url.ends_with("/")) o.client.url.pop_back();
  o.client.url += "/camera";
  const char* variable = std::getenv(kTokenVariable);
  o.client.token = args.text("--token", variable ? variable : "");
  o.client.ca_file = args.text("--ca");
  o.client.most_message_bytes = live::kMaxServerMessageBytes;
  o.delay_s = args.number("--delay-ms", 0, 0, 5000) / 1000;
  o.clock_off_us = int64_t(1e6 * args.number("--clock-off", 0, -1000, 1000));
  return o;
}

// Between the worker, which makes pictures, and the connection.
class Sender {
 public:
  explicit Sender(const CameraOptions& options) : options_(options) {}

  Status begin(const live::Rig& rig) {
    FOURDVT_ASSIGN(worker_, live::CameraWorker::start(
                                rig, options_.camera, [this](live::CameraPicture p) { push(std::move(p)); },
                                [this](const Error& error) { end(error); }));
    const std::lock_guard starting(start_mutex_);
    live::ClientEvents events;
    events.on_open = [this] {
      const std::lock_guard started(start_mutex_);
      send(worker_->hello());
      std::fprintf(stderr, "fourdvt: connected\n");
    };
    events.on_message = [this](std::span<const uint8_t> bytes, bool) {
      const std::lock_guard started(start_mutex_);
      obey(bytes);
    };
    events.on_close = [this](const std::string& reason, bool refused) {
      if (refused) return end({ErrorId::FetchFailed, options_.client.url + ": " + reason});
      std::fprintf(stderr, "fourdvt: %s; connecting again\n", reason.c_str());
    };
    FOURDVT_ASSIGN(client_, live::Client::start(options_.client, std::move(events)));
    return {};
  }

  // Sends what is due; to be called often.
  void turn() {
    for (;;) {
      live::CameraPicture picture;
      {
        const std::lock_guard lock(mutex_);
        if (waiting_.empty() || waiting_.front().due_us > now_us()) return;
        picture = std::move(waiting_.front().picture);
        waiting_.pop_front();
      }
      if (!client_->open()) continue;
      if (client_->queuedMessages() > kMostQueued) {
        ++dropped_;
        continue;
      }
      picture.captured_us += options_.clock_off_us;
      bytes_ += send(std::move(picture));
      ++sent_;
    }
  }

  std::string line() {
    const live::WorkerStats stats = worker_->stats();
    char text[160];
    std::snprintf(text, sizeof text,
                  "%s  %.1f ms a picture  %llu sent  %.0f kB/s  left out %llu, "
                  "not taken %llu",
                  client_->open() ? "connected" : "waiting  ", stats.keyed_ms, static_cast<unsigned long long>(sent_),
                  double(bytes_ - bytes_before_) / 1e3, static_cast<unsigned long long>(stats.left_out),
                  static_cast<unsigned long long>(dropped_));
    bytes_before_ = bytes_;
    return text;
  }

  std::optional<Error> ended() {
    const std::lock_guard lock(mutex_);
    return error_;
  }

 private:
  struct Waiting {
    int64_t due_us;
    live::CameraPicture picture;
  };

  void push(live::CameraPicture picture) {
    const std::lock_guard lock(mutex_);
    waiting_.push_back({now_us() + int64_t(1e6 * options_.delay_s), std::move(picture)});
    if (waiting_.size() > size_t(100)) waiting_.pop_front();
  }
  void end(const Error& error) {
    const std::lock_guard lock(mutex_);
    error_ = error;
  }
  size_t send(const live::FromCamera& message) {
    auto bytes = std::make_shared<const std::vector<uint8_t>>(live::writeFromCamera(message));
    const size_t size = bytes->size();
    client_->send(std::move(bytes));
    return size;
  }
  void obey(std::span<const uint8_t> bytes) {
    const auto message = live::readToCamera(bytes);
    if (!message.ok()) return;
    if (const auto* question = std::get_if<live::ClockQuestion>(&message.value()))
      send(live::ClockAnswer{question->server_us, now_us() + options_.clock_off_us});
    else
      worker_->set(std::get<live::CameraSettings>(message.value()));
  }

  const CameraOptions options_;
  std::mutex start_mutex_;  // held until the client can be used
  uint64_t sent_ = 0, dropped_ = 0, bytes_ = 0,
           bytes_before_ = 0;  // of the thread that turns
  std::mutex mutex_;
  std::deque<Waiting> waiting_;
  std::optional<Error> error_;
  std::unique_ptr<live::CameraWorker> worker_;
  std::unique_ptr<live::Client> client_;  // its thread uses all above
};

}  // namespace

int liveCameraCommand(int argc, char** argv) {
  Args args(help(), argc, argv);
  const CameraOptions options = readOptions(args);
  if (const auto code = helpOrProblem(help(), args)) return *code;
  const auto rig = live::readRig(options.rig);
  if (!rig.ok()) return fail(rig.error());
  const std::atomic<bool>* stop = listenForStop();
  Sender sender(options);
  if (const Status begun = sender.begin(rig.value()); !begun.ok()) return fail(begun.error());
  auto next = std::chrono::steady_clock::now();
  while (!*stop) {
    if (const auto error = sender.ended()) return fail(*error);
    sender.turn();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    if (std::chrono::steady_clock::now() < next) continue;
    next += std::chrono::seconds(1);
    std::printf("%s\n", sender.line().c_str());
    std::fflush(stdout);
  }
  return kOk;
}

}  // namespace fourdvt::tools

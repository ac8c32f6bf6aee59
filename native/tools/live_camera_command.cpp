// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

#include "base/text.h"
#include "live/camera/camera_worker.h"
#include "live/net/websocket.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/terminal.h"

namespace fourdvt::tools {
namespace {

using Clock = std::chrono::steady_clock;

constexpr size_t kMaxQueuedPictures = 2;
constexpr auto kReopenPause = std::chrono::seconds(2);

struct CameraArguments {
  std::string rig_file, camera;
  live::ClientOptions client;
  double clock_off_s = 0, delay_s = 0;
  int64_t clockOff_us() const { return std::llround(clock_off_s * 1e6); }
};

// Appends the server's path.
std::string withPath(const std::string& url) {
  const size_t host = url.find("://");
  if (host == std::string::npos) return url;
  const size_t slash = url.find('/', host + 3);
  if (slash == std::string::npos) return url + "/camera";
  return slash + 1 == url.size() ? url + "camera" : url;
}

// Runs delayed actions sequentially.
class Later {
 public:
  explicit Later(double delay_s)
      : delay_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(delay_s))) {
    if (delay_s > 0) thread_ = std::thread([this] { run(); });
  }
  ~Later() {
    {
      const std::lock_guard lock(mutex_);
      is_stopping_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }
  void add(std::function<void()> action) {
    if (!thread_.joinable()) return action();
    const std::lock_guard lock(mutex_);
    waiting_.emplace_back(Clock::now() + delay_, std::move(action));
    changed_.notify_all();
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    while (!is_stopping_) {
      if (waiting_.empty()) {
        changed_.wait(lock);
      } else if (const auto due = waiting_.front().first; Clock::now() < due) {
        changed_.wait_until(lock, due);
      } else {
        const auto action = std::move(waiting_.front().second);
        waiting_.pop_front();
        lock.unlock();
        action();
        lock.lock();
      }
    }
  }

  const Clock::duration delay_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::pair<Clock::time_point, std::function<void()>>> waiting_;
  bool is_stopping_ = false;
  std::thread thread_;
};

// One camera and its connection.
class LiveCamera {
 public:
  LiveCamera(const live::Rig& rig, const CameraArguments& arguments, LiveLine& line)
      : rig_(rig), arguments_(arguments), line_(line), later_(arguments.delay_s) {}

  Status start() {
    FOURDVT_TRY(openWorker());
    live::ClientEvents events;
    events.on_open = [this] { opened(); };
    events.on_message = [this](std::span<const uint8_t> bytes, bool) { receive(bytes); };
    events.on_close = [this](const std::string& reason, bool is_refused) { closed(reason, is_refused); };
    const std::lock_guard lock(mutex_);
    FOURDVT_ASSIGN(client_, live::Client::start(arguments_.client, std::move(events)));
    return {};
  }

  // Stops the callers before their targets are destroyed.
  ~LiveCamera() {
    takeWorker().reset();
    std::shared_ptr<live::Client> client;
    {
      const std::lock_guard lock(mutex_);
      client = std::move(client_);
    }
    client.reset();
  }

  bool isRefused() const { return is_refused_; }

  // Reopens a source that has ended.
  void keepOpen() {
    if (!has_ended_ || Clock::now() < reopen_.load()) return;
    takeWorker().reset();
    has_ended_ = false;
    if (!openWorker().ok()) sourceEnded();
  }

  std::string statusLine(double passed_s) {
    const std::shared_ptr<live::CameraWorker> worker = presentWorker();
    const live::WorkerStats stats = worker ? worker->stats() : live::WorkerStats{};
    return printed("%s %s  %.1f pictures/s  %.1f ms to key  %.0f kB/s  dropped %llu  left out %llu",
                   arguments_.camera.c_str(),
                   has_ended_ ? "has no source"
                   : isOpen() ? "sends"
                              : "is not connected",
                   static_cast<double>(sent_.exchange(0)) / passed_s, stats.keyed_ms,
                   static_cast<double>(sent_bytes_.exchange(0)) / passed_s / 1e3,
                   static_cast<unsigned long long>(dropped_.load()), static_cast<unsigned long long>(stats.left_out));
  }

 private:
  std::shared_ptr<live::CameraWorker> presentWorker() {
    const std::lock_guard lock(mutex_);
    return worker_;
  }
  std::shared_ptr<live::CameraWorker> takeWorker() {
    const std::lock_guard lock(mutex_);
    return std::move(worker_);
  }
  std::shared_ptr<live::Client> client() {
    const std::lock_guard lock(mutex_);
    return client_;
  }
  bool isOpen() {
    const auto open = client();
    return open && open->open();
  }

  Status openWorker() {
    FOURDVT_ASSIGN(std::shared_ptr<live::CameraWorker> worker,
                   live::CameraWorker::start(
                       rig_, arguments_.camera, [this](live::CameraPicture picture) { send(std::move(picture)); },
                       [this](const Error& error) {
                         line_.note(error.message);
                         sourceEnded();
                       }));
    std::optional<live::CameraSettings> settings;
    {
      const std::lock_guard lock(mutex_);
      worker_ = worker;
      hello_ = worker->hello();
      settings = settings_;
    }
    if (settings) worker->set(*settings);
    return {};
  }

  void sourceEnded() {
    reopen_ = Clock::now() + kReopenPause;
    has_ended_ = true;
  }

  void opened() {
    line_.note("connected to " + arguments_.client.url);
    live::Hello hello;
    {
      const std::lock_guard lock(mutex_);
      hello = hello_;
    }
    sendMessage(hello);
  }

  void closed(const std::string& reason, bool is_refused) {
    if (reason != last_reason_) line_.note(reason);
    last_reason_ = reason;
    if (is_refused) is_refused_ = true;
  }

  void receive(std::span<const uint8_t> bytes) {
    last_reason_.clear();
    const auto message = live::readToCamera(bytes);
    if (!message.ok()) return line_.note(message.error().message);
    if (const auto* question = std::get_if<live::ClockQuestion>(&message.value())) {
      const auto now = std::chrono::system_clock::now().time_since_epoch();
      const int64_t now_us = std::chrono::duration_cast<std::chrono::microseconds>(now).count();
      sendMessage(live::ClockAnswer{question->server_us, now_us + arguments_.clockOff_us()});
      return;
    }
    std::shared_ptr<live::CameraWorker> worker;
    {
      const std::lock_guard lock(mutex_);
      settings_ = std::get<live::CameraSettings>(message.value());
      worker = worker_;
    }
    if (worker) worker->set(std::get<live::CameraSettings>(message.value()));
  }

  void send(live::CameraPicture picture) {
    picture.captured_us += arguments_.clockOff_us();
    const auto bytes = std::make_shared<std::vector<uint8_t>>(live::writeFromCamera(std::move(picture)));
    later_.add([this, bytes] {
      const auto open = client();
      if (!open || !open->open()) return;
      if (open->queuedMessages() > kMaxQueuedPictures) {
        ++dropped_;
        return;
      }
      ++sent_;
      sent_bytes_ += bytes->size();
      open->send(bytes);
    });
  }

  void sendMessage(const live::FromCamera& message) {
    if (const auto open = client()) open->send(std::make_shared<std::vector<uint8_t>>(live::writeFromCamera(message)));
  }

  const live::Rig& rig_;
  const CameraArguments& arguments_;
  LiveLine& line_;
  std::atomic<bool> is_refused_{false}, has_ended_{false};
  std::atomic<Clock::time_point> reopen_{};
  std::atomic<uint64_t> sent_{0}, sent_bytes_{0}, dropped_{0};
  std::string last_reason_;  // client thread only
  std::mutex mutex_;         // guards the members below
  live::Hello hello_;
  std::optional<live::CameraSettings> settings_;
  std::shared_ptr<live::CameraWorker> worker_;
  std::shared_ptr<live::Client> client_;
  Later later_;
};

}  // namespace

Result<int> liveCameraCommand(int argc, char** argv) {
  CameraArguments a;
  const char* token = std::getenv("FOURDVT_LIVE_TOKEN");
  a.client.token = token ? token : "";
  const Args args(
      {"live-camera RIG.json CAMERA --server ws://HOST:PORT [options]",
       "Reads the source of one camera of a live stage, finds the performer in its pictures, and sends outlines and "
       "pictures to fourdvt live. Connects again after every loss. Ends by Ctrl-C, or when the server refuses it.",
       {&a.rig_file, &a.camera},
       {{"--server URL", required(a.client.url), "ws://HOST:PORT or wss://HOST:PORT of fourdvt live (required)"},
        {"--token T", text(a.client.token),
         "the camera token of the server's --tokens file (default: FOURDVT_LIVE_TOKEN)"},
        {"--ca FILE", text(a.client.ca_file), "PEM of a certificate to trust besides the system's; for wss"},
        {"--clock-off S", number(a.clock_off_s, -1e6, 1e6),
         "pretend a clock that is S seconds ahead; for tests (default 0)"},
        {"--delay-ms X", number(a.delay_s, 0, 10000, 1e-3),
         "send everything X milliseconds later, 0 to 10000; for tests (default 0)"}}},
      argc, argv);
  if (const auto code = args.helpOrProblem()) return *code;
  a.client.url = withPath(a.client.url);
  const std::atomic<bool>* stop = listenForStop();
  FOURDVT_ASSIGN(const auto rig, live::readRig(a.rig_file));
  LiveLine line;
  LiveCamera camera(rig, a, line);
  FOURDVT_TRY(camera.start());
  for (int tenths = 1; !*stop && !camera.isRefused(); ++tenths) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    camera.keepOpen();
    if (tenths % 10 == 0) line.show(camera.statusLine(1));
  }
  line.end();
  return camera.isRefused() ? kFailed : kOk;
}

}  // namespace fourdvt::tools

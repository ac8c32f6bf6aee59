// SPDX-License-Identifier: Apache-2.0
#include "live/service.h"

#include <atomic>
#include <set>

#include "live/cameras.h"
#include "live/pages.h"

namespace fourdvt::live {
namespace {

constexpr double kTickSeconds = 0.2, kPageMessagesPerSecond = 20, kCameraMessagesPerSecond = 240;
constexpr int kTicksPerConsoleMessage = 5;
constexpr size_t kMaxCameraQueuedBytes = 1 << 20, kMaxPageQueuedBytes = 16 << 20, kMaxConsoleBehind = 4;

Bytes textBytes(const std::string& text) { return std::make_shared<std::vector<uint8_t>>(text.begin(), text.end()); }

HttpAnswer plainAnswer(int status, const std::string& body) {
  HttpAnswer answer;
  answer.status = status;
  answer.body = body;
  return answer;
}

// Role required by a path of HTTP or WebSocket.
Role roleOf(const std::string& path) {
  if (path == "/camera") return Role::Camera;
  if (path == "/live") return Role::Viewer;
  if (path == "/console" || path == "/status.json" || path.compare(0, 9, "/cameras/") == 0) return Role::Console;
  return Role::Anyone;
}

const char* roleName(Role role) {
  switch (role) {
    case Role::Camera:
      return "a camera";
    case Role::Viewer:
      return "a viewer";
    case Role::Console:
      return "a console";
    case Role::Anyone:
      break;
  }
  return "a page";
}

// Log limited to one line per second, so that peers cannot flood the console.
class Complaints {
 public:
  explicit Complaints(SayLine say) : say_(std::move(say)) {}
  uint64_t count() const { return count_; }
  void add(const std::string& line) {  // called on the server's thread, as are all below
    ++count_;
    if (said_)
      ++unsaid_;
    else
      say_(line);
    said_ = true;
  }
  void everySecond() {
    if (unsaid_ > 0) say_(std::to_string(unsaid_) + " more connections or messages refused");
    said_ = unsaid_ > 0;
    unsaid_ = 0;
  }

 private:
  const SayLine say_;
  std::atomic<uint64_t> count_{0};
  uint64_t unsaid_ = 0;
  bool said_ = false;
};

class Service final : public LiveService, private ServerHandler {
 public:
  Service(const Rig& rig, const LiveOptions& options, const SayLine& say)
      : rig_(rig), options_(options), say_(say), complaints_(say) {}

  ~Service() override {
    server_.reset();  // its connections use all members below
    {
      const std::lock_guard lock(settings_mutex_);
      is_stopping_ = true;
    }
    sources_.reset();
    pipeline_.reset();
  }

  Status open() {
    PipelineEvents events;
    events.on_frame = [this](Bytes frame, bool key) { viewers_.send(frame, key); };
    events.on_settings = [this](size_t camera, const CameraSettings& settings) { set(camera, settings); };
    events.on_warning = say_;
    FOURDVT_ASSIGN(pipeline_, options_.start_pipeline(rig_, options_.pipeline, std::move(events)));
    if (options_.tolerance_px > 0) pipeline_->setTolerance(options_.tolerance_px);
    std::vector<bool> is_local;
    for (const RigCamera& camera : rig_.cameras) is_local.push_back(options_.reads_sources && camera.source);
    auto cameras = std::make_unique<Cameras>(rig_, *pipeline_, is_local, options_.hello_s);
    auto sources = std::make_unique<Sources>(rig_, options_.start_worker, *pipeline_, say_);
    Sources& opening = *sources;
    {
      const std::lock_guard lock(settings_mutex_);
      cameras_ = std::move(cameras);
      sources_ = std::move(sources);
    }
    if (options_.reads_sources) FOURDVT_TRY(opening.open());
    FOURDVT_ASSIGN(server_, Server::start(options_.server, *this));
    server_->every(kTickSeconds, [this] { tick(); });
    return {};
  }

  uint16_t port() const override { return server_->port(); }

  LiveStatus status() override { return {pipeline_->status(), viewers_.status(), complaints_.count()}; }

 private:
  void set(size_t camera, const CameraSettings& settings) {
    const std::lock_guard lock(settings_mutex_);
    if (is_stopping_ || !sources_) return;
    sources_->set(camera, settings);
    cameras_->set(camera, settings);
  }

  Verdict verdict(const HttpRequest& request) {
    const Role role = roleOf(request.path);
    const Verdict verdict = judge(options_.access, request, role);
    if (verdict != Verdict::Allowed)
      complaints_.add(request.peer + ": refused as " + roleName(role) + ": " + verdictText(verdict));
    return verdict;
  }

  HttpAnswer onGet(const HttpRequest& request) override {
    if (const Verdict v = verdict(request); v != Verdict::Allowed) return plainAnswer(verdictStatus(v), verdictText(v));
    if (roleOf(request.path) == Role::Anyone) return fileAnswer(request.path);
    HttpAnswer answer;
    if (request.path == "/status.json") {
      answer.type = "application/json";
      answer.body = statusJson(status());
    } else if (request.path.compare(0, 9, "/cameras/") == 0) {
      answer = cameraAnswer(request.path.substr(9));
    } else {
      answer = plainAnswer(400, "this address is for WebSockets");
    }
    answer.allow_origin = request.origin;
    return answer;
  }

  HttpAnswer fileAnswer(const std::string& path) {
    if (path != "/" || webFile(options_.web_folder, "/live/").status != 200) return webFile(options_.web_folder, path);
    HttpAnswer answer = plainAnswer(302, "");
    answer.location = "/live/";
    return answer;
  }

  HttpAnswer cameraAnswer(const std::string& file) {
    const size_t dot = std::min(file.rfind('.'), file.size());
    const std::string name = file.substr(0, dot), extension = file.substr(dot);
    for (size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
      const PinholeCamera& pinhole = rig_.cameras[camera].camera.pinhole;
      if (pinhole.name != name) continue;
      const CameraPicture picture = pipeline_->lastPicture(camera);
      HttpAnswer answer;
      if (extension == ".json") {
        answer.type = "application/json";
        answer.body = pictureJson(picture, pinhole.width, pinhole.height);
        return answer;
      }
      if (extension != ".jpg" || picture.jpeg.empty()) break;
      answer.type = "image/jpeg";
      answer.body.assign(picture.jpeg.begin(), picture.jpeg.end());
      return answer;
    }
    return plainAnswer(404, "there is no such camera, or it has sent no picture");
  }

  Result<SocketLimits> onOpening(const HttpRequest& request, int& refused_status) override {
    const bool is_page = request.path == "/live" || request.path == "/console";
    if (is_page) return SocketLimits{kMaxPageMessageBytes, kPageMessagesPerSecond, kMaxPageQueuedBytes};
    refused_status = 404;
    if (request.path != "/camera")
      return Error{ErrorId::InvalidArgument, "WebSockets are at /camera, /live and /console"};
    const Verdict v = verdict(request);
    refused_status = verdictStatus(v);
    if (v != Verdict::Allowed) return Error{ErrorId::InvalidArgument, verdictText(v)};
    return SocketLimits{kMaxCameraMessageBytes, kCameraMessagesPerSecond, kMaxCameraQueuedBytes};
  }

  void onOpen(const std::shared_ptr<Connection>& connection) override {
    const HttpRequest& request = connection->request();
    if (request.path == "/camera") return cameras_->add(connection);
    if (const Verdict v = verdict(request); v != Verdict::Allowed)
      return connection->close(v == Verdict::WrongToken ? kCloseToken : kCloseOrigin, verdictText(v));
    if (request.path == "/console") {
      consoles_.insert(connection);
      connection->send(textBytes(statusJson(status())), true);
      return;
    }
    viewers_.add(connection, pipeline_->manifest());
    pipeline_->wantKey();
  }

  void onMessage(const std::shared_ptr<Connection>& connection, std::span<const uint8_t> bytes, bool text) override {
    const bool is_camera = connection->request().path == "/camera";
    const Status status = is_camera ? cameras_->receive(connection, bytes, text) : fromPage(connection, bytes, text);
    if (status.ok()) return;
    complaints_.add(connection->request().peer + ": " + status.error().message);
    connection->close(kCloseInvalid, status.error().message);
  }

  Status fromPage(const std::shared_ptr<Connection>& connection, std::span<const uint8_t> bytes, bool text) {
    if (!text) return Error{ErrorId::StreamInvalid, "live page: bytes in place of text"};
    FOURDVT_ASSIGN(const PageMessage message, readPageMessage(bytes, consoles_.count(connection) > 0));
    if (message.ping_t) connection->send(textBytes(pongJson(*message.ping_t, serverNow_us())), true);
    if (message.tolerance_px) pipeline_->setTolerance(*message.tolerance_px);
    if (message.crf) pipeline_->setCrf(*message.crf);
    return {};
  }

  void onClose(const std::shared_ptr<Connection>& connection) override {
    cameras_->remove(connection);
    viewers_.remove(connection);
    consoles_.erase(connection);
  }

  void tick() {
    cameras_->tick();
    if (++ticks_ % kTicksPerConsoleMessage != 0) return;
    if (options_.reads_sources) sources_->tellClock();
    complaints_.everySecond();
    if (consoles_.empty()) return;
    const Bytes message = textBytes(statusJson(status()));
    for (const auto& console : consoles_)
      if (console->queuedMessages() < kMaxConsoleBehind) console->send(message, true);
  }

  const Rig rig_;
  const LiveOptions options_;
  const SayLine say_;
  std::unique_ptr<Pipeline> pipeline_;
  Viewers viewers_;
  std::mutex settings_mutex_;  // guards settings between the pipeline's thread, start and shutdown
  bool is_stopping_ = false;
  std::unique_ptr<Sources> sources_;
  std::unique_ptr<Cameras> cameras_;

  // Used on the server's thread.
  Complaints complaints_;
  std::set<std::shared_ptr<Connection>> consoles_;
  int ticks_ = 0;
  std::unique_ptr<Server> server_;
};

}  // namespace

Result<std::unique_ptr<LiveService>> LiveService::start(const Rig& rig, const LiveOptions& options, SayLine say) {
  LiveOptions checked = options;
  checked.access.loopback = isLoopback(options.server.address);
  const bool is_tls = !options.server.certificate_file.empty() && !options.server.key_file.empty();
  if (!checked.access.loopback && !(is_tls && options.access.tokens.demanded()))
    return Error{ErrorId::InvalidArgument, "other machines reach a server that listens on " + options.server.address +
                                               "; give it --certificate and --key, and --tokens, too"};
  auto service = std::make_unique<Service>(rig, checked, say);
  FOURDVT_TRY(service->open());
  return std::unique_ptr<LiveService>(std::move(service));
}

}  // namespace fourdvt::live

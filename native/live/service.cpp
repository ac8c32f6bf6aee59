// SPDX-License-Identifier: Apache-2.0
#include "live/service.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "live/camera/camera_worker.h"
#include "live/static_files.h"
#include "live/viewers.h"

namespace fourdvt::live {
namespace {

using Json = nlohmann::json;

constexpr size_t kPageMessageBytes = 1024;
constexpr double kPageMessagesPerS = 20, kCameraMessagesPerS = 240;
constexpr double kTick_s = 0.1;
constexpr int kTicksPerSecond = 10,
              kQuickQuestions = 5;                  // a new camera's clock is read so often at once
constexpr auto kRestart = std::chrono::seconds(2);  // a source that has ended is opened again

int64_t now_us() {
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

Bytes bytesOf(const std::string& text) {
  return std::make_shared<const std::vector<uint8_t>>(text.begin(), text.end());
}

enum class Path { None, Camera, Live, Console };
Path pathOf(const HttpRequest& request) {
  return request.path == "/camera"    ? Path::Camera
         : request.path == "/live"    ? Path::Live
         : request.path == "/console" ? Path::Console
                                      : Path::None;
}

std::string pictureJson(const CameraPicture& picture, const PinholeCamera& camera) {
  Json rings = Json::array();
  for (const Ring16& ring : picture.rings) {
    Json& points = rings.emplace_back(Json::array());
    for (const Point16& p : ring) points.push_back({p.x / kPointsPerPixel, p.y / kPointsPerPixel});
  }
  const package::Rect& crop = picture.crop;
  return Json{{"size", {camera.width, camera.height}},
              {"crop", {crop.x, crop.y, crop.width, crop.height}},
              {"number", picture.number},
              {"rings", std::move(rings)}}
      .dump();
}

class Service final : public LiveService, private ServerHandler {
 public:
  Service(const Rig& rig, const ServiceOptions& options, std::function<void(const std::string&)> on_line)
      : rig_(rig),
        options_(options),
        on_line_(std::move(on_line)),
        workers_(rig.cameras.size()),
        cameras_(rig.cameras.size()) {}

  ~Service() override {
    {
      const std::lock_guard lock(workers_mutex_);
      stop_ = true;
    }
    stopping_.notify_all();
    if (sources_.joinable()) sources_.join();
    std::vector<std::shared_ptr<CameraWorker>> workers(workers_.size());
    {
      const std::lock_guard lock(workers_mutex_);
      workers_.swap(workers);
    }
    workers.clear();
    viewers_.close();
    {
      const std::lock_guard lock(cameras_mutex_);
      closing_ = true;
      cameras_.assign(cameras_.size(), {});
    }
    server_.reset();  // no connection calls the pipeline any more
    pipeline_.reset();
  }

  Status begin() {
    PipelineEvents events;
    events.on_frame = [this](Bytes frame, bool key) { viewers_.send(frame, key); };
    events.on_settings = [this](size_t camera, const CameraSettings& settings) { tell(camera, settings); };
    events.on_warning = on_line_;
    FOURDVT_ASSIGN(pipeline_, options_.make_pipeline(rig_, options_.pipeline, std::move(events)));
    if (options_.local_sources)
      for (size_t c = 0; c < rig_.cameras.size(); ++c)
        if (rig_.cameras[c].source) FOURDVT_TRY(startWorker(c));
    FOURDVT_ASSIGN(server_, Server::start(options_.server, *this));
    server_->every(kTick_s, [this] { tick(); });
    sources_ = std::thread([this] { keepSources(); });
    return {};
  }

  uint16_t port() const override { return server_->port(); }

  ServiceStatus status() const override {
    const Viewers::Status v = viewers_.status();
    return {pipeline_->status(), v.viewers, v.skipped, v.bytes_per_s, refused_};
  }

 private:
  struct Peer {
    Path path = Path::None;
    std::shared_ptr<Connection> connection;
    int camera = -1;  // once it has said its name
  };
  struct CameraLink {
    std::shared_ptr<Connection> connection;
    int quick_questions = 0;
  };

  // --- sources of this process ---

  Status startWorker(size_t camera) {
    const std::string& name = rig_.cameras[camera].camera.pinhole.name;
    auto on_picture = [this, camera](CameraPicture picture) {
      const size_t bytes = writeFromCamera(picture).size();
      pipeline_->onPicture(camera, std::move(picture), bytes, now_us());
    };
    auto on_end = [this, camera, name](const Error& error) {
      on_line_("camera " + name + ": " + error.message);
      pipeline_->setConnected(camera, false);
      const std::lock_guard lock(workers_mutex_);
      ended_[camera] = true;
    };
    pipeline_->setConnected(camera, true);
    sameClock(camera);
    auto worker = CameraWorker::start(rig_, name, std::move(on_picture), std::move(on_end));
    if (!worker.ok()) {
      pipeline_->setConnected(camera, false);
      return worker.error();
    }
    worker.value()->set(pipeline_->settings(camera));
    const std::lock_guard lock(workers_mutex_);
    workers_[camera] = worker.take();
    return {};
  }

  void sameClock(size_t camera) {
    const int64_t now = now_us();
    pipeline_->onClock(camera, {now, now}, now);
  }

  // Opens sources that have ended again, until it succeeds.
  void keepSources() {
    std::unique_lock lock(workers_mutex_);
    while (!stopping_.wait_for(lock, kRestart, [&] { return stop_; })) {
      for (auto& [camera, ended] : ended_) {
        if (!ended) continue;
        std::shared_ptr<CameraWorker> old = std::move(workers_[camera]);
        ended = false;
        lock.unlock();
        old.reset();
        const Status started = startWorker(camera);
        lock.lock();
        if (!started.ok()) ended = true;
        if (stop_) return;
      }
    }
  }

  // --- the server's thread ---

  Refusal refusal(const HttpRequest& request, Role role) const { return refusalOf(options_.access, request, role); }

  HttpAnswer onGet(const HttpRequest& request) override {
    const bool is_camera = request.path.starts_with("/cameras/");
    if (is_camera || request.path == "/status.json") {
      if (const Refusal r = refusal(request, Role::Console); r != Refusal::None) {
        ++refused_;
        return {r == Refusal::Token ? 401 : 403, "text/plain; charset=utf-8", refusalText(r), {}, {}, {}};
      }
      return is_camera ? cameraAnswer(request.path.substr(9))
                       : HttpAnswer{200, "application/json", statusJson(status()), {}, {}, {}};
    }
    const auto file = staticFile(options_.web_folder, request.path);
    if (request.path == "/" && staticFile(options_.web_folder, "/live/index.html")) {
      HttpAnswer answer{302, "text/plain; charset=utf-8", "/live/", {}, {}, {}};
      answer.location = "/live/";
      return answer;
    }
    if (!file) return {404, "text/plain; charset=utf-8", "there is no such file", {}, {}, {}};
    return {200, file->type, {}, file->path, {}, {}};
  }

  HttpAnswer cameraAnswer(const std::string& file) const {
    for (size_t c = 0; c < rig_.cameras.size(); ++c) {
      const PinholeCamera& camera = rig_.cameras[c].camera.pinhole;
      const bool json = file == camera.name + ".json";
      if (!json && file != camera.name + ".jpg") continue;
      const CameraPicture picture = pipeline_->lastPicture(c);
      if (json) return {200, "application/json", pictureJson(picture, camera), {}, {}, {}};
      if (picture.jpeg.empty()) break;
      return {200, "image/jpeg", std::string(picture.jpeg.begin(), picture.jpeg.end()), {}, {}, {}};
    }
    return {404, "text/plain; charset=utf-8", "there is no such camera, or it has no picture", {}, {}, {}};
  }

  Result<SocketLimits> onOpening(const HttpRequest& request, int& refused_status) override {
    switch (pathOf(request)) {
      case Path::None:
        refused_status = 404;
        return Error{ErrorId::InvalidArgument, "connections go to /camera, /live or /console"};
      case Path::Camera:
        if (const Refusal r = refusal(request, Role::Camera); r != Refusal::None) {
          ++refused_;
          refused_status = r == Refusal::Token ? 401 : 403;
          return Error{ErrorId::InvalidArgument, refusalText(r)};
        }
        return SocketLimits{kMaxCameraMessageBytes, kCameraMessagesPerS, 1u << 20};
      default:
        return SocketLimits{kPageMessageBytes, kPageMessagesPerS, 16u << 20};
    }
  }

  void onOpen(const std::shared_ptr<Connection>& connection) override {
    const Path path = pathOf(connection->request());
    if (path != Path::Camera) {
      const Refusal r = refusal(connection->request(), path == Path::Live ? Role::Viewer : Role::Console);
      if (r != Refusal::None) {
        ++refused_;
        connection->close(r == Refusal::Token ? kCloseToken : kCloseOrigin, refusalText(r));
        return;
      }
    }
    peers_[connection.get()] = {path, connection, -1};
    if (path == Path::Live) {
      viewers_.add(connection, pipeline_->manifest());
      pipeline_->wantKey();
    } else if (path == Path::Console) {
      connection->send(bytesOf(statusJson(status())), true);
    }
  }

  void onMessage(const std::shared_ptr<Connection>& connection, std::span<const uint8_t> bytes, bool text) override {
    const auto found = peers_.find(connection.get());
    if (found == peers_.end()) return;
    Peer& peer = found->second;
    const Status done = peer.path == Path::Camera ? fromCamera(peer, bytes, text) : fromPage(peer, bytes, text);
    if (done.ok()) return;
    ++refused_;
    on_line_(connection->request().peer + ": " + done.error().message);
    connection->close(kCloseInvalid, done.error().message);
  }

  void onClose(const std::shared_ptr<Connection>& connection) override {
    const auto found = peers_.find(connection.get());
    if (found == peers_.end()) return;
    const Peer peer = found->second;
    peers_.erase(found);
    viewers_.remove(connection.get());
    if (peer.camera < 0) return;
    {
      const std::lock_guard lock(cameras_mutex_);
      if (cameras_[size_t(peer.camera)].connection != connection) return;  // another one has taken its place
      cameras_[size_t(peer.camera)] = {};
    }
    pipeline_->setConnected(size_t(peer.camera), false);
  }

  Status fromCamera(Peer& peer, std::span<const uint8_t> bytes, bool text) {
    if (text) return Error{ErrorId::StreamInvalid, "a camera sent text; use the same version of fourdvt on all sides"};
    FOURDVT_ASSIGN(auto message, readFromCamera(bytes));
    if (const auto* hello = std::get_if<Hello>(&message)) return meet(peer, *hello);
    if (peer.camera < 0)
      return Error{ErrorId::StreamInvalid, "a camera must say its name first; use the same version of fourdvt"};
    const auto camera = size_t(peer.camera);
    if (const auto* answer = std::get_if<ClockAnswer>(&message))
      pipeline_->onClock(camera, *answer, now_us());
    else
      pipeline_->onPicture(camera, std::move(std::get<CameraPicture>(message)), bytes.size(), now_us());
    return {};
  }

  Status meet(Peer& peer, const Hello& hello) {
    if (peer.camera >= 0) return Error{ErrorId::StreamInvalid, "a camera said its name twice"};
    size_t camera = 0;
    while (camera < rig_.cameras.size() && rig_.cameras[camera].camera.pinhole.name != hello.camera) ++camera;
    if (camera == rig_.cameras.size())
      return Error{ErrorId::InvalidArgument,
                   "the server's rig has no camera \"" + hello.camera + "\"; use the same RIG.json"};
    const PinholeCamera& known = rig_.cameras[camera].camera.pinhole;
    if (hello.width != known.width || hello.height != known.height)
      return Error{ErrorId::FrameSize, "camera \"" + hello.camera + "\" sends " + std::to_string(hello.width) + "x" +
                                           std::to_string(hello.height) + ", the server's rig has " +
                                           std::to_string(known.width) + "x" + std::to_string(known.height) +
                                           "; use the same RIG.json"};
    if (isLocal(camera))
      return Error{ErrorId::InvalidArgument, "camera \"" + hello.camera +
                                                 "\" is read by the server itself; set its source to "
                                                 "null in its RIG.json"};
    peer.camera = int(camera);
    std::shared_ptr<Connection> before;
    {
      const std::lock_guard lock(cameras_mutex_);
      if (closing_) return {};
      before = std::move(cameras_[camera].connection);
      cameras_[camera] = {peer.connection, kQuickQuestions};
    }
    if (before) before->close(kCloseReplaced, "another process sends this camera's pictures");
    pipeline_->setConnected(camera, true);
    send(peer.connection, pipeline_->settings(camera));
    send(peer.connection, ClockQuestion{now_us()});
    return {};
  }

  bool isLocal(size_t camera) const { return options_.local_sources && rig_.cameras[camera].source.has_value(); }

  Status fromPage(Peer& peer, std::span<const uint8_t> bytes, bool text) {
    const Json message = text ? Json::parse(bytes.begin(), bytes.end(), nullptr, false) : Json();
    if (!message.is_object()) return Error{ErrorId::StreamInvalid, "a page sent what is no JSON object"};
    if (const auto type = message.find("type"); type != message.end() && *type == "ping") {
      const Json answer = {{"type", "pong"}, {"t", message.value("t", Json())}, {"now", now_us()}};
      peer.connection->send(bytesOf(answer.dump(-1, ' ', false, Json::error_handler_t::replace)), true);
      return {};
    }
    if (peer.path != Path::Console) return Error{ErrorId::StreamInvalid, "a viewer may send pings alone"};
    const auto number = [&](const char* name) {
      const auto at = message.find(name);
      return at != message.end() && at->is_number() ? std::optional(at->get<double>()) : std::nullopt;
    };
    const auto tolerance = number("tolerance_px"), crf = number("crf");
    if ((tolerance && !(*tolerance >= 0 && *tolerance <= 64)) || (crf && !(*crf >= 0 && *crf <= 51)))
      return Error{ErrorId::InvalidArgument,
                   "the console asks for a tolerance beyond 0 to 64, or a CRF "
                   "beyond 0 to 51"};
    if (tolerance) pipeline_->setTolerance(*tolerance);
    if (crf) pipeline_->setCrf(int(*crf));
    return {};
  }

  void tick() {
    ++ticks_;
    const bool second = ticks_ % kTicksPerSecond == 0;
    std::vector<std::shared_ptr<Connection>> asked;
    {
      const std::lock_guard lock(cameras_mutex_);
      for (CameraLink& link : cameras_)
        if (link.connection && (second || link.quick_questions-- > 0)) asked.push_back(link.connection);
    }
    for (const auto& connection : asked) send(connection, ClockQuestion{now_us()});
    if (!second) return;
    for (size_t c = 0; c < rig_.cameras.size(); ++c)
      if (isLocal(c)) sameClock(c);
    Bytes line;
    for (const auto& [id, peer] : peers_) {
      if (peer.path != Path::Console || peer.connection->queuedMessages() > Viewers::kMostWaiting) continue;
      if (!line) line = bytesOf(statusJson(status()));
      peer.connection->send(line, true);
    }
  }

  // --- any thread ---

  static void send(const std::shared_ptr<Connection>& connection, const ToCamera& message) {
    connection->send(std::make_shared<const std::vector<uint8_t>>(writeToCamera(message)));
  }

  void tell(size_t camera, const CameraSettings& settings) {
    {
      const std::lock_guard lock(workers_mutex_);
      if (workers_[camera]) workers_[camera]->set(settings);
    }
    const std::lock_guard lock(cameras_mutex_);
    if (cameras_[camera].connection) send(cameras_[camera].connection, settings);
  }

  const Rig rig_;
  const ServiceOptions options_;
  const std::function<void(const std::string&)> on_line_;
  std::unique_ptr<Pipeline> pipeline_;
  Viewers viewers_;
  std::atomic<uint64_t> refused_ = 0;

  std::mutex workers_mutex_;  // of what follows
  std::condition_variable stopping_;
  bool stop_ = false;
  std::vector<std::shared_ptr<CameraWorker>> workers_;  // by camera; null: none of this process
  std::map<size_t, bool> ended_;
  std::thread sources_;

  std::mutex cameras_mutex_;
  std::vector<CameraLink> cameras_;  // connected ones, by camera
  bool closing_ = false;

  std::map<const Connection*, Peer> peers_;  // of the server's thread, as `ticks_`
  int ticks_ = 0;
  std::unique_ptr<Server> server_;
};

}  // namespace

Result<std::unique_ptr<LiveService>> LiveService::start(const Rig& rig, const ServiceOptions& options,
                                                        std::function<void(const std::string&)> on_line) {
  auto service = std::make_unique<Service>(rig, options, std::move(on_line));
  FOURDVT_TRY(service->begin());
  return std::unique_ptr<LiveService>(std::move(service));
}

}  // namespace fourdvt::live

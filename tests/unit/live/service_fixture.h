// SPDX-License-Identifier: Apache-2.0
// A live service with a pipeline that only records its calls, for the tests of this folder.
#pragma once

#include <atomic>

#include "live/service.h"
#include "socket_fixture.h"

namespace fourdvt::live {

// Calls that a FakePipeline has received; outlives it.
struct PipelineLog {
  Log<std::string> calls;  // "connected 0", "clock 1 5", "picture 0 7", "key", "tolerance 2", "crf 30"
  PipelineEvents events;
  std::atomic<bool> has_picture{false};

  size_t count(const std::string& call) {
    const auto all = calls.values();
    return static_cast<size_t>(std::count(all.begin(), all.end(), call));
  }
  bool waitFor(const std::string& call, size_t times = 1) {
    return calls.waitUntil([&](const std::vector<std::string>& all) {
      return static_cast<size_t>(std::count(all.begin(), all.end(), call)) >= times;
    });
  }
};

class FakePipeline final : public Pipeline {
 public:
  FakePipeline(PipelineLog& log, size_t cameras) : log_(log), cameras_(cameras) {}
  const std::string& manifest() const override { return manifest_; }
  CameraSettings settings(size_t camera) const override { return {1.5 + static_cast<double>(camera), 80, {}}; }
  void setConnected(size_t camera, bool connected) override {
    log_.calls.add((connected ? "connected " : "gone ") + std::to_string(camera));
  }
  void onClock(size_t camera, const ClockAnswer& answer, int64_t) override {
    const std::string offset = std::to_string(answer.camera_us - answer.server_us);
    log_.calls.add("clock " + std::to_string(camera) + " " + offset);
  }
  void onPicture(size_t camera, CameraPicture picture, size_t, int64_t) override {
    log_.calls.add("picture " + std::to_string(camera) + " " + std::to_string(picture.number));
  }
  void wantKey() override { log_.calls.add("key"); }
  void setTolerance(double tolerance_px) override {
    log_.calls.add("tolerance " + std::to_string(static_cast<int>(tolerance_px)));
  }
  void setCrf(int crf) override { log_.calls.add("crf " + std::to_string(crf)); }
  PipelineStatus status() const override {
    PipelineStatus status;
    status.frames = 42;
    for (size_t c = 0; c < cameras_; ++c) status.cameras.push_back({"camera" + std::to_string(c)});
    return status;
  }
  CameraPicture lastPicture(size_t) const override {
    CameraPicture picture;
    if (!log_.has_picture) return picture;
    picture.number = 9;
    picture.rings = {{{16, 32}, {24, 32}, {24, 48}}};
    picture.crop = {1, 2, 3, 4};
    picture.jpeg = {0xff, 0xd8, 0xff};
    return picture;
  }

 private:
  PipelineLog& log_;
  const size_t cameras_;
  const std::string manifest_ = "{\"the\":\"manifest\"}";
};

class ServiceTest : public testing::Test {
 protected:
  ServiceTest() {
    for (const char* name : {"left", "right"}) {
      RigCamera camera;
      camera.camera.pinhole.name = name;
      camera.camera.pinhole.width = 640;
      camera.camera.pinhole.height = 480;
      rig_.cameras.push_back(camera);
    }
    options_.start_pipeline = [this](const Rig& rig, const PipelineOptions&,
                                     PipelineEvents events) -> Result<std::unique_ptr<Pipeline>> {
      pipeline_.events = std::move(events);
      return std::unique_ptr<Pipeline>(std::make_unique<FakePipeline>(pipeline_, rig.cameras.size()));
    };
  }
  void start() {
    auto started = LiveService::start(rig_, options_, [this](const std::string& line) { lines_.add(line); });
    ASSERT_TRUE(started.ok()) << started.error().message;
    service_ = started.take();
    port_ = service_->port();
  }
  std::string url(const std::string& path) const { return "ws://127.0.0.1:" + std::to_string(port_) + path; }
  void frame(const std::string& bytes, bool key) { pipeline_.events.on_frame(bytesOf(bytes), key); }

  // Opens a WebSocket. `status`: expected status of the handshake; 101: it is open.
  std::unique_ptr<RawSocket> open(const std::string& target, const std::string& fields = {}, int status = 101,
                                  int receive_bytes = 0) {
    auto socket = std::make_unique<RawSocket>(port_, receive_bytes);
    socket->send(upgradeRequest(target, fields));
    EXPECT_EQ(statusOf(socket->receive("\r\n\r\n")), status) << target << " " << fields;
    return socket;
  }
  static std::string fromCamera(const FromCamera& message) { return clientFrame(textOf(writeFromCamera(message))); }
  std::unique_ptr<RawSocket> openCamera(const std::string& name, const std::string& target = "/camera") {
    auto socket = open(target);
    socket->send(fromCamera(Hello{name, 640, 480}));
    return socket;
  }
  // Expects that another viewer and another camera are still served.
  void expectOthersServed() {
    LoggedClient viewer(url("/live"));
    ASSERT_TRUE(viewer.messages.waitFor(1));
    frame("a key", true);
    ASSERT_TRUE(viewer.messages.waitFor(2));
    EXPECT_EQ(viewer.messages.values()[1], "a key");
    const size_t before = pipeline_.count("picture 1 77");
    const auto camera = openCamera("right");
    camera->send(fromCamera(CameraPicture{77}));
    EXPECT_TRUE(pipeline_.waitFor("picture 1 77", before + 1));
  }

  Rig rig_;
  LiveOptions options_;
  PipelineLog pipeline_;
  Log<std::string> lines_;
  std::unique_ptr<LiveService> service_;
  uint16_t port_ = 0;
};

}  // namespace fourdvt::live

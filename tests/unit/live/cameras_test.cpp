// SPDX-License-Identifier: Apache-2.0
#include "service_fixture.h"

namespace fourdvt::live {
namespace {

class LiveCameras : public ServiceTest {};

TEST_F(LiveCameras, AreMetAndHandTheirMessagesOn) {
  start();
  const auto camera = openCamera("right");
  ASSERT_TRUE(pipeline_.waitFor("connected 1"));
  const auto settings = readToCamera(std::vector<uint8_t>());  // settings are sent first, then a clock question
  EXPECT_FALSE(settings.ok());
  const std::string first = camera->receiveFrame(), second = camera->receiveFrame();
  const auto told = readToCamera({reinterpret_cast<const uint8_t*>(first.data()), first.size()});
  ASSERT_TRUE(told.ok());
  EXPECT_EQ(std::get<CameraSettings>(told.value()).tolerance_px, 2.5);
  const auto asked = readToCamera({reinterpret_cast<const uint8_t*>(second.data()), second.size()});
  ASSERT_TRUE(asked.ok());
  const int64_t server_us = std::get<ClockQuestion>(asked.value()).server_us;
  camera->send(fromCamera(ClockAnswer{server_us, server_us + 5}));
  camera->send(fromCamera(CameraPicture{3}));
  EXPECT_TRUE(pipeline_.waitFor("clock 1 5"));
  EXPECT_TRUE(pipeline_.waitFor("picture 1 3"));
}

TEST_F(LiveCameras, AreAskedForTheirClockAgainAndAgain) {
  start();
  LoggedClient camera(url("/camera"));
  ASSERT_TRUE(camera.opens.waitFor(1));
  camera.client->send(std::make_shared<std::vector<uint8_t>>(writeFromCamera(Hello{"left", 640, 480})));
  EXPECT_TRUE(camera.messages.waitFor(7));
}

TEST_F(LiveCameras, AreToldSettingsThatChange) {
  start();
  LoggedClient camera(url("/camera"));
  ASSERT_TRUE(camera.opens.waitFor(1));
  camera.client->send(std::make_shared<std::vector<uint8_t>>(writeFromCamera(Hello{"left", 640, 480})));
  ASSERT_TRUE(pipeline_.waitFor("connected 0"));
  const CameraSettings settings{7, 50, {1, 2, 3, 4}};
  pipeline_.events.on_settings(0, settings);
  const std::string expected = textOf(writeToCamera(settings));
  EXPECT_TRUE(camera.messages.waitUntil(
      [&](const std::vector<std::string>& all) { return std::find(all.begin(), all.end(), expected) != all.end(); }));
}

TEST_F(LiveCameras, ASecondConnectionReplacesTheFirst) {
  start();
  const auto first = openCamera("left");
  ASSERT_TRUE(pipeline_.waitFor("connected 0"));
  const auto second = openCamera("left");
  EXPECT_EQ(first->receiveClose(), kCloseReplaced);
  ASSERT_TRUE(pipeline_.waitFor("connected 0", 2));
  second->send(fromCamera(CameraPicture{5}));
  ASSERT_TRUE(pipeline_.waitFor("picture 0 5"));
  expectOthersServed();
  EXPECT_EQ(pipeline_.count("gone 0"), 0u);  // the first connection's end does not disconnect the camera
  second->send(clientFrame(std::string("\x03\xe8", 2), 8));
  EXPECT_TRUE(pipeline_.waitFor("gone 0"));
}

TEST_F(LiveCameras, InvalidMessagesCloseThatConnectionOnly) {
  start();
  std::string damaged = textOf(writeFromCamera(CameraPicture{1}));
  damaged.pop_back();
  const auto afterHello = [](const std::string& frame) { return fromCamera(Hello{"left", 640, 480}) + frame; };
  const std::vector<std::string> wrong = {
      clientFrame("garbage"),
      clientFrame(""),
      clientFrame("text", 1),
      fromCamera(CameraPicture{1}),           // before the Hello
      fromCamera(ClockAnswer{}),              // the same
      fromCamera(Hello{"nobody", 640, 480}),  // not in the rig
      fromCamera(Hello{"left", 641, 480}),    // another size than in the rig
      afterHello(fromCamera(Hello{"right", 640, 480})),
      afterHello(clientFrame(damaged)),
      afterHello(clientFrame("text", 1)),
  };
  for (size_t i = 0; i < wrong.size(); ++i) {
    const auto camera = open("/camera");
    camera->send(wrong[i]);
    EXPECT_EQ(camera->receiveClose(), kCloseInvalid) << i;
  }
  EXPECT_TRUE(eventually([&] { return service_->status().refused == wrong.size(); }));
  EXPECT_EQ(pipeline_.count("picture 0 1"), 0u);
  EXPECT_GE(lines_.values().size(), 1u);
  expectOthersServed();
}

TEST_F(LiveCameras, OversizeMessagesAndFloodsCloseThatConnectionOnly) {
  start();
  const auto large = openCamera("left");
  large->send(std::string("\x82\xff\0\0\0\0\0\x40\0\x01", 10) + std::string(4, '\0'));  // header of 4 MiB and 1 byte
  EXPECT_EQ(large->receiveClose(), 1009);
  const auto flood = openCamera("left");
  std::string burst;
  for (int i = 0; i < 2000; ++i) burst += fromCamera(ClockAnswer{});
  flood->send(burst);
  EXPECT_EQ(flood->receiveClose(), 1008);
  EXPECT_TRUE(pipeline_.waitFor("gone 0", 2));
  expectOthersServed();
}

TEST_F(LiveCameras, AConnectionWithoutHelloIsClosed) {
  options_.hello_s = 0.3;
  start();
  EXPECT_EQ(open("/camera")->receiveClose(), kCloseInvalid);
}

class FakeWorker final : public CameraWorker {
 public:
  explicit FakeWorker(Log<CameraSettings>& settings) : settings_(settings) {}
  void set(const CameraSettings& settings) override { settings_.add(settings); }
  WorkerStats stats() const override { return {}; }
  Hello hello() const override { return {"left", 640, 480}; }

 private:
  Log<CameraSettings>& settings_;
};

TEST_F(LiveCameras, SourcesOfTheRigAreReadWithTheServersClock) {
  Log<CameraSettings> settings;
  std::function<void(CameraPicture)> on_picture;
  rig_.cameras[0].source = SourcePlace{"a.mp4", "", {}};
  options_.start_worker = [&](const Rig&, const std::string& name, std::function<void(CameraPicture)> picture,
                              std::function<void(const Error&)>) -> Result<std::unique_ptr<CameraWorker>> {
    EXPECT_EQ(name, "left");
    on_picture = std::move(picture);
    return std::unique_ptr<CameraWorker>(std::make_unique<FakeWorker>(settings));
  };
  start();
  EXPECT_EQ(pipeline_.count("connected 0"), 1u);
  EXPECT_EQ(pipeline_.count("connected 1"), 0u);
  on_picture(CameraPicture{8});
  EXPECT_EQ(pipeline_.count("picture 0 8"), 1u);
  ASSERT_EQ(settings.values().size(), 1u);
  EXPECT_EQ(settings.values()[0].tolerance_px, 1.5);
  pipeline_.events.on_settings(0, {9, 50, {}});
  EXPECT_EQ(settings.values().back().tolerance_px, 9);
  EXPECT_TRUE(pipeline_.waitFor("clock 0 0", 3));                // at once, and every second
  EXPECT_EQ(openCamera("left")->receiveClose(), kCloseInvalid);  // this process reads it itself
  expectOthersServed();
  service_.reset();  // before its workers' objects
}

TEST_F(LiveCameras, ASourceThatEndsIsOpenedAgain) {
  Log<CameraSettings> settings;
  std::function<void(const Error&)> on_end;
  std::atomic<int> starts{0};
  rig_.cameras[0].source = SourcePlace{"a.mp4", "", {}};
  options_.start_worker = [&](const Rig&, const std::string&, std::function<void(CameraPicture)>,
                              std::function<void(const Error&)> end) -> Result<std::unique_ptr<CameraWorker>> {
    if (++starts == 2) return Error{ErrorId::FileMissing, "unplugged"};
    on_end = std::move(end);
    return std::unique_ptr<CameraWorker>(std::make_unique<FakeWorker>(settings));
  };
  start();
  on_end({ErrorId::FileUnreadable, "the cable was pulled"});
  EXPECT_TRUE(eventually([&] { return starts == 3; }));
  EXPECT_TRUE(pipeline_.waitFor("connected 0", 3));
  EXPECT_EQ(lines_.values()[0], "camera left: the cable was pulled");
  service_.reset();  // before its workers' objects
}

TEST_F(LiveCameras, ASourceThatCannotBeOpenedAtFirstIsAnError) {
  rig_.cameras[0].source = SourcePlace{"a.mp4", "", {}};
  options_.start_worker = [](const Rig&, const std::string&, std::function<void(CameraPicture)>,
                             std::function<void(const Error&)>) -> Result<std::unique_ptr<CameraWorker>> {
    return Error{ErrorId::FileMissing, "a.mp4: not there"};
  };
  const auto started = LiveService::start(rig_, options_, [](const std::string&) {});
  ASSERT_FALSE(started.ok());
  EXPECT_EQ(started.error().id, ErrorId::FileMissing);
  options_.reads_sources = false;
  start();
  expectOthersServed();
}

}  // namespace
}  // namespace fourdvt::live

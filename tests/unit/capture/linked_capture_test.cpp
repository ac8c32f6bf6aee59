// SPDX-License-Identifier: Apache-2.0
#include "capture/folder/linked_capture.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "capture_fixture.h"

namespace fourdvt::capture {
namespace {

TEST(LinkedCapture, HeldOutFramesFollowTheNewRange) {
  SmallCapture given;
  given.write("capture.json", R"({"fps": 25, "sequences": [{"name": "walk", "frames": 3, "test_frames": [0, 1, 2]}]})");
  auto capture = given.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  CaptureSequence& walk = capture.value().sequences[0];
  walk.first_frame = 1;
  walk.frame_count = 1;
  walk.offset_frames = {{capture.value().cameras[0].pinhole.name, 0.25}};
  const std::filesystem::path to = given.path() + "_linked";
  std::filesystem::create_directories(to);
  LinkOptions options;
  options.sequences = {"walk"};
  options.own_times = true;
  const Status linked = linkCapture(capture.value(), to.string(), options);
  ASSERT_TRUE(linked.ok()) << linked.error().message;
  std::ifstream file(to / "capture.json");
  const auto sequence = nlohmann::json::parse(file)["sequences"][0];
  EXPECT_EQ(sequence["frames"], 1);
  EXPECT_EQ(sequence["first_frame"], 1);
  EXPECT_EQ(sequence["test_frames"], nlohmann::json::array({0}));  // given frame 1; frames 0 and 2 are outside
  EXPECT_EQ(sequence["offset_frames"].size(), 1u);
  std::filesystem::remove_all(to);
}

}  // namespace
}  // namespace fourdvt::capture

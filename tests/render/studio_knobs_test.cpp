// SPDX-License-Identifier: Apache-2.0
// What the studio's knobs do to a whole capture, as its reader finds it.
#include "capture/capture.h"
#include "platform/ffmpeg_video.h"
#include "studio_fixture.h"

namespace fourdvt::studio {
namespace {

class StudioKnobsTest : public StudioTest {
 protected:
  // One motion of 6 frames.
  StudioOptions walk(const std::string& name) const {
    StudioOptions o = small(name);
    o.sequences = {"walk"};
    o.truth_at.clear();
    return o;
  }
};

TEST_F(StudioKnobsTest, FirstFramesOfAClipAreThoseOfTheWhole) {
  StudioOptions o = small("whole");
  o.truth_at.clear();
  ASSERT_TRUE(run(o));
  const auto whole = filesOf(o.folder);
  o.folder = folder_ + "/cut";
  o.frames = 2;
  auto report = run(o);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report.value().frames, 4u);
  const auto cut = filesOf(o.folder);
  EXPECT_TRUE(cut.at("walk/cam01/000001.png") == whole.at("walk/cam01/000001.png"));
  EXPECT_EQ(cut.count("walk/cam01/000002.png"), 0u);
  auto capture = capture::openCapture(o.folder, platform::openVideoFile);
  ASSERT_TRUE(capture) << capture.error().message;
  EXPECT_TRUE(capture.value().classes.empty());
  for (const capture::CaptureSequence& sequence : capture.value().sequences) {
    EXPECT_EQ(sequence.frame_count, 2u);
    EXPECT_FALSE(sequence.loop);
  }
}

TEST_F(StudioKnobsTest, RoomMayHaveNoPlates) {
  StudioOptions o = walk("bare");
  o.room = true;
  o.plates = 0;
  o.frames = 1;
  ASSERT_TRUE(run(o));
  const auto files = filesOf(o.folder);
  for (const auto& [name, bytes] : files) EXPECT_NE(name.substr(0, 10), "background") << name;
  EXPECT_EQ(files.at("capture.json").find("\"background\""), std::string::npos);
  EXPECT_EQ(files.count("mattes_true/walk/mask00/000000.png"), 1u);
}

TEST_F(StudioKnobsTest, RoomMustHoldTheCameras) {
  StudioOptions o = walk("room");
  o.room = true;
  o.frames = 1;
  o.room_size_m = 3;
  const auto refused = run(o);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().id, ErrorId::InvalidArgument);
  o.room_size_m = 15;
  ASSERT_TRUE(run(o));
  auto capture = capture::openCapture(o.folder, platform::openVideoFile);
  ASSERT_TRUE(capture) << capture.error().message;
  ASSERT_TRUE(capture.value().room);
  EXPECT_EQ(capture.value().room->max.x, 7.5f);
  EXPECT_EQ(capture.value().room->min.z, -7.5f);
}

}  // namespace
}  // namespace fourdvt::studio

// SPDX-License-Identifier: Apache-2.0
// Sequences that travel through the room, and are shown in place.
#include <glm/gtc/constants.hpp>

#include "capture/capture.h"
#include "capture_fixture.h"

namespace fourdvt::capture {
namespace {

// The quad of SmallCapture goes on by 0.1 units a frame along z.
TEST(CaptureTravel, IsTakenOutOfPositions) {
  SmallCapture files;
  files.write("capture.json",
              SmallCapture::json(R"(, "travel": {"shift": [0, 0.3], "place": [0.5, 0.2]})", "centimetre"));
  const auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  const CaptureSequence& walk = capture.value().sequences[0];
  for (uint32_t f = 0; f < 3; ++f) {
    const auto room = readMeshFrame(capture.value(), walk, f), place = readMeshFrameInPlace(capture.value(), walk, f);
    ASSERT_TRUE(room.ok() && place.ok());
    EXPECT_NEAR(room.value()[1].z, 0.001 * f, 1e-7);
    EXPECT_NEAR(place.value()[1].z, 0.01 * (0.15 - 0.2), 1e-7);  // half way: the quad's first place and 0.15
    EXPECT_NEAR(place.value()[1].x, room.value()[1].x - 0.005, 1e-7);
    EXPECT_EQ(place.value()[1].y, room.value()[1].y);
  }
}

TEST(CaptureTravel, KeepsTheHeadingHalfWay) {
  CaptureSequence walk;
  walk.frame_count = 4;
  walk.travel = CaptureTravel{{glm::half_pi<double>(), {1, 2}}, {}};
  const glm::dvec3 p(0.3, 1, -0.2);
  for (uint32_t f = 0; f < 4; ++f) {
    Positions there = {glm::vec3(shareOf(walk.travel->motion, f / 4.0)(p))};
    putInPlace(walk, f, there);
    EXPECT_LT(glm::distance(glm::dvec3(there[0]), shareOf(walk.travel->motion, 0.5)(p)), 1e-6);
  }
}

// The other end of a loop shows the performer elsewhere.
TEST(CaptureTravel, PicturesDoNotGoRound) {
  SmallCapture files;
  const std::string travel = R"("travel": {"shift": [0, 1]}, "offset_frames": {"cam01": -1}, "frames": 2)";
  const auto json = [&](const std::string& more) {
    files.write("capture.json", R"({"fps": 25, "sequences": [{"name": "walk", "loop": true, )" + travel + more + "}]}");
    return files.open();
  };
  EXPECT_NE(json("").error().message.find("\"first_frame\" to 1"), std::string::npos);
  const auto capture = json(R"(, "first_frame": 1)");
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture.value().sequences[0].pictureOf("cam01", 0), 0u);
  EXPECT_EQ(capture.value().sequences[0].pictureOf("cam00", 1), 2u);
}

TEST(CaptureTravel, NeedsNumbers) {
  SmallCapture files;
  for (const char* wrong : {"1", R"({"turn_deg": 3})", R"({"shift": [1]})", R"({"shift": [1, 1e300]})",
                            R"({"shift": [1, 2], "turn_deg": 360})", R"({"shift": [1, 2], "turn_deg": "3"})",
                            R"({"shift": [1, 2], "place": [0, 0, 0]})"}) {
    files.write("capture.json", SmallCapture::json(std::string(R"(, "travel": )") + wrong));
    expectError(files.open(), ErrorId::CaptureJson, "\"travel\" of \"walk\"");
  }
}

}  // namespace
}  // namespace fourdvt::capture

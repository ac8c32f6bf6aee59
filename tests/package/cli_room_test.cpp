// SPDX-License-Identifier: Apache-2.0
// Captures with a room: invalid rooms, the baked room, and the character in front of it.
#include <gtest/gtest.h>

#include <filesystem>

#include "../unit/character_files.h"
#include "command.h"
#include "platform/files.h"

namespace fourdvt::test {
namespace {

namespace fs = std::filesystem;

const std::string kSmall = " --texture 128 --layers 2 --gop 4 --jobs 2 --renditions highest";
const std::string kRoom = R"({"min": [-6, 0, -6], "max": [6, 4, 6]})";

void giveRoom(const std::string& capture, const std::string& room) {
  ASSERT_EQ(shell("sed -i '0,/{/s//{\"room\": " + room + ", /' " + capture + "/capture.json").code, 0);
}

// Writes plates of one colour, with a mark of the camera's own.
void addPlates(const std::string& capture) {
  for (int c = 0; c < 4; ++c) {
    Image plate(160, 160, 3, 0);
    for (size_t i = 0; i < plate.pixels.size(); i += 3)
      plate.pixels[i] = 150, plate.pixels[i + 1] = 120, plate.pixels[i + 2] = static_cast<uint8_t>(60 + c);
    fs::create_directories(capture + "/background");
    ASSERT_TRUE(platform::writeImage(capture + "/background/cam0" + std::to_string(c) + ".png", plate).ok());
  }
}

TEST(Room, MustContainThePerformer) {
  const std::string capture = smallCapture("room-wrong-capture", 2), out = scratch("room-wrong");
  addPlates(capture);
  giveRoom(capture, R"({"min": [-6, 0, -6], "max": [6, 0.5, 6]})");
  const Outcome outcome = fourdvt("bake " + capture + " -o " + out + "/box" + kSmall);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_TRUE(isOneLineWith(outcome, capture + "/capture.json: \"room\" does not contain the performer"))
      << outcome.output;
  EXPECT_NE(outcome.output.find("unit"), std::string::npos);
  EXPECT_FALSE(exists(out + "/box"));
}

TEST(Room, NeedsPlates) {
  const std::string capture = smallCapture("room-plates-capture", 2), out = scratch("room-plates");
  addPlates(capture);
  fs::remove(capture + "/background/cam02.png");
  giveRoom(capture, kRoom);
  const Outcome outcome = fourdvt("bake " + capture + " -o " + out + "/box" + kSmall);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_TRUE(isOneLineWith(outcome, "background/cam02.png")) << outcome.output;
  EXPECT_NE(outcome.output.find("room"), std::string::npos);
  EXPECT_FALSE(exists(out + "/box"));
}

TEST(Room, IsBakedInspectedAndDrawn) {
  const std::string capture = smallCapture("room-capture", 4), out = scratch("room");
  ASSERT_EQ(fourdvt("bake " + capture + " -o " + out + "/without" + kSmall).code, 0);
  EXPECT_FALSE(exists(fileNamed(out + "/without", "room.jpg")));
  EXPECT_EQ(readText(out + "/without/character.gltf").find("\"room\""), std::string::npos);
  const Outcome none = fourdvt("render " + out + "/without --background room -o " + out + "/none.png");
  EXPECT_EQ(none.code, 1);
  EXPECT_TRUE(isOneLineWith(none, "has no room")) << none.output;

  addPlates(capture);
  giveRoom(capture, kRoom);
  const Outcome bake = fourdvt("bake " + capture + " -o " + out + "/box" + kSmall);
  ASSERT_EQ(bake.code, 0) << bake.output;
  const std::string room = fileNamed(out + "/box", "room.jpg"), name = fs::path(room).filename();
  EXPECT_LE(fs::file_size(room), 300'000u);
  // The room changes no other file.
  EXPECT_EQ(differences(out + "/without", out + "/box"), (std::vector<std::string>{"character.gltf", name}));
  const Outcome inspect = fourdvt("inspect " + out + "/box");
  EXPECT_EQ(inspect.code, 0) << inspect.output;
  EXPECT_NE(inspect.output.find(name), std::string::npos) << inspect.output;

  const std::string still = out + "/still.png";
  ASSERT_EQ(fourdvt("render " + out + "/box --background room -o " + still + " --size 120x160").code, 0);
  const auto picture = platform::readImage(still);
  ASSERT_TRUE(picture.ok());
  for (const auto& [x, y] : {std::pair{3, 3}, {116, 3}, {3, 156}, {116, 156}}) {
    const uint8_t* p = picture.value().at(x, y);
    EXPECT_NEAR(p[0], 150, 4) << x << " " << y;
    EXPECT_NEAR(p[1], 120, 4) << x << " " << y;
    EXPECT_EQ(p[3], 255);
  }

  damage(room, 700, 8);
  const Outcome damaged = fourdvt("inspect " + out + "/box");
  EXPECT_EQ(damaged.code, 1);
  EXPECT_TRUE(isOneLineWith(damaged, name)) << damaged.output;
  fs::remove(room);
  EXPECT_TRUE(isOneLineWith(fourdvt("inspect " + out + "/box"), name));
}

}  // namespace
}  // namespace fourdvt::test

// SPDX-License-Identifier: Apache-2.0
#include "live/protocol/camera_messages.h"

#include <gtest/gtest.h>

#include <limits>

namespace fourdvt::live {
namespace {

using Bytes = std::vector<uint8_t>;

CameraPicture picture() {
  CameraPicture m;
  m.number = 7;
  m.captured_us = 1790000000123456;
  m.keyed_us = 1234;
  m.rings = {{{0, 0}, {0, 160}, {160, 0}}, {{65520, 65520}, {1, 2}, {3, 4}, {5, 6}}};
  m.crop = {10, 20, 30, 40};
  m.jpeg = {0xff, 0xd8, 1, 2, 3};
  return m;
}

void expectRefused(const Bytes& bytes, ErrorId id = ErrorId::StreamInvalid) {
  const auto read = readFromCamera(bytes);
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().id, id);
  EXPECT_EQ(read.error().message.find('\n'), std::string::npos);
}

void expectRefusedToCamera(const ToCamera& message) {
  const auto read = readToCamera(writeToCamera(message));
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().id, ErrorId::StreamInvalid);
}

TEST(FromCamera, ComesBackAsItWas) {
  const auto hello = readFromCamera(writeFromCamera(Hello{"cam07", 4095, 1}));
  ASSERT_TRUE(hello.ok());
  EXPECT_EQ(std::get<Hello>(hello.value()).camera, "cam07");
  EXPECT_EQ(std::get<Hello>(hello.value()).width, 4095);
  EXPECT_EQ(std::get<Hello>(hello.value()).height, 1);

  const auto clock = readFromCamera(writeFromCamera(ClockAnswer{-5, std::numeric_limits<int64_t>::max()}));
  ASSERT_TRUE(clock.ok());
  EXPECT_EQ(std::get<ClockAnswer>(clock.value()).server_us, -5);
  EXPECT_EQ(std::get<ClockAnswer>(clock.value()).camera_us, std::numeric_limits<int64_t>::max());

  const auto read = readFromCamera(writeFromCamera(picture()));
  ASSERT_TRUE(read.ok());
  const auto& m = std::get<CameraPicture>(read.value());
  EXPECT_EQ(m.number, picture().number);
  EXPECT_EQ(m.captured_us, picture().captured_us);
  EXPECT_EQ(m.keyed_us, picture().keyed_us);
  EXPECT_EQ(m.rings, picture().rings);
  EXPECT_EQ(m.jpeg, picture().jpeg);
  EXPECT_EQ(m.crop.x, 10);
  EXPECT_EQ(m.crop.y, 20);
  EXPECT_EQ(m.crop.width, 30);
  EXPECT_EQ(m.crop.height, 40);
  EXPECT_TRUE(readFromCamera(writeFromCamera(CameraPicture{})).ok());  // neither outline nor picture
}

TEST(FromCamera, IsRefusedWhereItEndsEarly) {
  for (const FromCamera& message : {FromCamera(Hello{"cam07", 64, 48}), FromCamera(ClockAnswer{1, 2})}) {
    Bytes bytes = writeFromCamera(message);
    for (size_t end = 0; end < bytes.size(); ++end) {
      const auto read = readFromCamera({bytes.data(), end});
      EXPECT_FALSE(read.ok()) << end;
    }
    bytes.push_back(0);
    expectRefused(bytes);
  }
  // The picture follows the rings, up to the message's end.
  const Bytes bytes = writeFromCamera(picture());
  for (size_t end = 0; end <= bytes.size() - picture().jpeg.size(); ++end)
    expectRefused(Bytes(bytes.begin(), bytes.begin() + long(end)));
}

TEST(FromCamera, RefusesUnknownKindsAndVersions) {
  expectRefused({});
  expectRefused({0});
  expectRefused({6, 1, 2, 3});
  expectRefused(writeToCamera(ClockQuestion{1}));
  Bytes newer = writeFromCamera(Hello{"cam07", 64, 48});
  ++newer[1];
  expectRefused(newer, ErrorId::Unsupported);
}

TEST(FromCamera, RefusesNamesAndSizesBeyondTheLimits) {
  for (const char* name : {"", "a b", "a\nb", "a/b", "a\\b", "a\"b", "\x7f", "\xc3\xa4"})
    expectRefused(writeFromCamera(Hello{name, 64, 48}));
  EXPECT_TRUE(readFromCamera(writeFromCamera(Hello{std::string(128, 'c'), 64, 48})).ok());
  expectRefused(writeFromCamera(Hello{std::string(129, 'c'), 64, 48}));
  for (const auto& [width, height] : {std::pair(0, 48), std::pair(64, 0), std::pair(4096, 48), std::pair(64, 4096)})
    expectRefused(writeFromCamera(Hello{"cam07", width, height}));
}

TEST(FromCamera, RefusesRingsBeyondTheLimits) {
  const Ring16 triangle{{0, 0}, {0, 16}, {16, 0}};
  CameraPicture m = picture();
  m.rings.assign(kMaxRings, triangle);
  EXPECT_TRUE(readFromCamera(writeFromCamera(m)).ok());
  m.rings.push_back(triangle);
  expectRefused(writeFromCamera(m));

  m.rings = {Ring16(kMaxRingPoints - 3), triangle};
  EXPECT_TRUE(readFromCamera(writeFromCamera(m)).ok());
  m.rings = {Ring16(kMaxRingPoints - 2), triangle};
  expectRefused(writeFromCamera(m));
  m.rings = {{{0, 0}, {1, 1}}};
  expectRefused(writeFromCamera(m));
  m.rings = {{}};
  expectRefused(writeFromCamera(m));
}

TEST(FromCamera, RefusesCropsThatDoNotSuit) {
  for (const package::Rect& crop : {package::Rect{0, 0, 0, 5}, package::Rect{0, 0, 5, 0}, package::Rect{4090, 0, 6, 5},
                                    package::Rect{0, 4090, 5, 6}, package::Rect{65535, 0, 65535, 1}}) {
    CameraPicture m = picture();
    m.crop = crop;
    expectRefused(writeFromCamera(m));
  }
  CameraPicture without = picture(), without_crop = picture();
  without.jpeg.clear();
  expectRefused(writeFromCamera(without));
  without_crop.crop = {};
  expectRefused(writeFromCamera(without_crop));
}

TEST(FromCamera, RefusesMessagesThatAreTooLong) {
  CameraPicture m = picture();
  const size_t rest = writeFromCamera(m).size() - m.jpeg.size();
  m.jpeg.assign(kMaxCameraMessageBytes - rest, 1);
  EXPECT_TRUE(readFromCamera(writeFromCamera(m)).ok());
  m.jpeg.push_back(1);
  expectRefused(writeFromCamera(m));
}

TEST(ToCamera, ComesBackAsItWas) {
  const auto question = readToCamera(writeToCamera(ClockQuestion{-3}));
  ASSERT_TRUE(question.ok());
  EXPECT_EQ(std::get<ClockQuestion>(question.value()).server_us, -3);
  for (const CameraSettings& settings : {CameraSettings{0, 1, {}}, CameraSettings{64, 100, {1, 2, 3, 4}},
                                         CameraSettings{1.25, 85, {0, 0, 4095, 4095}}}) {
    const auto read = readToCamera(writeToCamera(settings));
    ASSERT_TRUE(read.ok());
    const auto& m = std::get<CameraSettings>(read.value());
    EXPECT_EQ(m.tolerance_px, settings.tolerance_px);
    EXPECT_EQ(m.jpeg_quality, settings.jpeg_quality);
    EXPECT_EQ(m.region.x, settings.region.x);
    EXPECT_EQ(m.region.height, settings.region.height);
    EXPECT_LE(writeToCamera(settings).size(), kMaxServerMessageBytes);
  }
}

TEST(ToCamera, RefusesWhatIsOutOfRange) {
  for (const double tolerance_px : {-0.1, 64.1, double(std::numeric_limits<float>::quiet_NaN()), 1e30})
    expectRefusedToCamera(CameraSettings{tolerance_px, 85, {}});
  for (const int quality : {0, 101, 255}) expectRefusedToCamera(CameraSettings{1, quality, {}});
  expectRefusedToCamera(CameraSettings{1, 85, {0, 0, 5, 0}});
  expectRefusedToCamera(CameraSettings{1, 85, {4000, 0, 96, 5}});
}

TEST(ToCamera, RefusesOtherLengthsAndKinds) {
  for (const ToCamera& message : {ToCamera(ClockQuestion{1}), ToCamera(CameraSettings{})}) {
    Bytes bytes = writeToCamera(message);
    for (size_t end = 0; end < bytes.size(); ++end) EXPECT_FALSE(readToCamera({bytes.data(), end}).ok());
    bytes.push_back(0);
    EXPECT_FALSE(readToCamera(bytes).ok());
  }
  EXPECT_FALSE(readToCamera(writeFromCamera(Hello{"cam07", 64, 48})).ok());
  EXPECT_FALSE(readToCamera(Bytes(kMaxServerMessageBytes + 1, 5)).ok());
}

}  // namespace
}  // namespace fourdvt::live

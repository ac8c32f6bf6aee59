// SPDX-License-Identifier: Apache-2.0
// Hints: accepted and rejected files, and tracking of strokes.
#include "mattes/hints.h"

#include <gtest/gtest.h>

#include "../capture_fixture.h"
#include "mattes_fixture.h"

namespace fourdvt::mattes {
namespace {

using capture::SmallCapture;

// 16 × 12 pixels, transparent except a white pixel at (3, 2) and a black one at (8, 6).
Image strokePicture() {
  Image out(SmallCapture::kWidth, SmallCapture::kHeight, 4);
  std::fill_n(out.at(3, 2), 4, uint8_t(255));
  out.at(8, 6)[3] = 255;
  return out;
}

Result<Strokes> read(const SmallCapture& files, const std::string& left_out = "") {
  auto capture = files.open();
  EXPECT_TRUE(capture.ok());
  auto& cameras = capture.value().cameras;
  cameras.erase(
      std::remove_if(cameras.begin(), cameras.end(), [&](const auto& c) { return c.pinhole.name == left_out; }),
      cameras.end());
  return readStrokes(capture.value(), capture.value().sequences[0]);
}

void expectRefused(const SmallCapture& files, const std::string& part) {
  const auto got = read(files);
  ASSERT_FALSE(got.ok()) << part;
  EXPECT_NE(got.error().message.find(part), std::string::npos) << got.error().message;
}

TEST(Hints, AreReadFromBothPlaces) {
  SmallCapture files;
  EXPECT_TRUE(read(files).value()[0].empty());
  files.write("hints/cam01/000002.png", strokePicture());
  auto strokes = read(files);
  ASSERT_TRUE(strokes.ok()) << strokes.error().message;
  EXPECT_TRUE(strokes.value()[0].empty());
  const cv::Mat& got = strokes.value()[1].at(2);
  EXPECT_EQ(got.at<uint8_t>(2, 3), kObjectStroke);
  EXPECT_EQ(got.at<uint8_t>(6, 8), kBackgroundStroke);
  EXPECT_EQ(cv::countNonZero(got), 2);
  files.remove("hints");
  files.write("hints/walk/cam00/000000.png", strokePicture());
  EXPECT_EQ(read(files).value()[0].count(0), 1u);
  // Hints of omitted cameras and unrequested sequences are ignored.
  EXPECT_EQ(read(files, "cam01").value().size(), 1u);
  EXPECT_TRUE(read(files, "cam00").ok());
  files.remove("hints");
  files.write("run/cam00/000000.png", SmallCapture::grey(3));
  files.write("hints/run/cam00/000000.png", strokePicture());
  EXPECT_TRUE(read(files).ok());
}

TEST(Hints, OfAnotherSizeOrNameAreRefused) {
  SmallCapture files;
  files.write("hints/cam00/000001.png", Image(20, 12, 4));
  expectRefused(files, "hints/cam00/000001.png: picture of 20x12 pixels");
  files.remove("hints");
  files.write("hints/cam7/000001.png", strokePicture());
  expectRefused(files, "hints/cam7: no camera has this name");
  files.remove("hints");
  files.write("hints/cam00/000003.png", strokePicture());
  expectRefused(files, "000003.png: hints are PNG files named after their picture, 000000.png to 000002.png;");
  files.remove("hints");
  files.write("hints/cam00/here.png", strokePicture());
  expectRefused(files, "here.png: hints are PNG files named after their picture");
  files.remove("hints");
  files.write("hints/cam00/000001.png", std::string("not a picture"));
  expectRefused(files, "000001.png: not a readable picture");
  files.remove("hints");
  files.write("hints/cam00/000001.png", strokePicture());
  auto capture = files.open().take();
  capture.sequences.push_back(capture.sequences[0]);
  const auto several = readStrokes(capture, capture.sequences[0]);
  ASSERT_FALSE(several.ok());
  EXPECT_NE(several.error().message.find("the capture has several sequences"), std::string::npos);
}

TEST(Hints, ThinStrokesTravelAndEnd) {
  Image flat(64, 48, 3, 90);
  cv::Mat dot(48, 64, CV_8U, cv::Scalar(0));
  dot.at<uint8_t>(21, 33) = kObjectStroke;
  HintTrack track;
  track.advance(flat, &dot);
  EXPECT_LE(track.cost().at<float>(21, 33), -kObeyed);
  EXPECT_FALSE(track.idle());
  track.advance(flat, nullptr);
  // Tracked or lost, its effect ends.
  const cv::Mat cost = track.cost();
  EXPECT_GT(cost.empty() ? 0 : cost.at<float>(21, 33), -kObeyed);
}

// A textured square at (x, 40) on a textured room, 160 × 120.
Image square(int x, bool there) {
  Image out(160, 120, 3);
  for (int y = 0; y < out.height; ++y)
    for (int u = 0; u < out.width; ++u) {
      const bool in = there && u >= x && u < x + 40 && y >= 40 && y < 80;
      const double level = in ? 150 + 90 * hashed(uint32_t(u - x) / 4, uint32_t(y) / 4, 1)
                              : 100 * hashed(uint32_t(u) / 4, uint32_t(y) / 4, 2);
      for (int c = 0; c < 3; ++c) out.at(u, y)[c] = uint8_t(level);
    }
  return out;
}

TEST(Hints, TravelWithWhatTheyWerePaintedOn) {
  cv::Mat strokes(120, 160, CV_8U, cv::Scalar(0));
  strokes(cv::Rect(32, 52, 16, 16)) = kObjectStroke;
  strokes(cv::Rect(120, 90, 16, 16)) = kBackgroundStroke;
  HintTrack track;
  EXPECT_TRUE(track.idle());
  track.advance(square(20, true), &strokes);
  EXPECT_FALSE(track.idle());
  EXPECT_LE(track.cost().at<float>(60, 40), -kObeyed);
  for (int k = 1; k <= 5; ++k) track.advance(square(20 + 3 * k, true), nullptr);
  // The square has moved by 15 pixels, and its strokes with it. Strokes on the room stay in place.
  const cv::Mat cost = track.cost();
  EXPECT_LT(cost.at<float>(60, 40 + 15), 0);
  EXPECT_GT(cost.at<float>(60, 40 + 15), -kObeyed);
  EXPECT_EQ(cost.at<float>(60, 34), 0);
  EXPECT_GT(cost.at<float>(98, 128), 0);
  // It vanishes, and its strokes with it.
  track.advance(square(0, false), nullptr);
  EXPECT_EQ(track.cost().at<float>(60, 55), 0);
}

}  // namespace
}  // namespace fourdvt::mattes

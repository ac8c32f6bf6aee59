// SPDX-License-Identifier: Apache-2.0
// Pictures whose files mark them as rotated, mirrored, non-square or in another colour space, and the report on these.
#include <lcms2.h>

#include "capture/picture_report.h"
#include "capture/pictures.h"
#include "capture/still_marks.h"
#include "capture/upright.h"
#include "capture_fixture.h"
#include "mattes/frame_reader.h"
#include "png_marks.h"

namespace fourdvt::capture {
namespace {

std::string deflated(const std::string& bytes) {
  std::string out(compressBound(uLong(bytes.size())), '\0');
  uLongf length = out.size();
  compress(reinterpret_cast<Bytef*>(out.data()), &length, reinterpret_cast<const Bytef*>(bytes.data()),
           uLong(bytes.size()));
  out.resize(length);
  return out;
}

std::string profileOf(const cmsCIExyYTRIPLE& primaries, double gamma) {
  const cmsCIExyY d65{0.3127, 0.3290, 1};
  cmsToneCurve* curve = cmsBuildGamma(nullptr, gamma);
  cmsToneCurve* curves[3] = {curve, curve, curve};
  cmsHPROFILE profile = cmsCreateRGBProfile(&d65, &primaries, curves);
  cmsUInt32Number bytes = 0;
  cmsSaveProfileToMem(profile, nullptr, &bytes);
  std::string out(bytes, '\0');
  cmsSaveProfileToMem(profile, out.data(), &bytes);
  cmsCloseProfile(profile);
  cmsFreeToneCurve(curve);
  return out;
}

const cmsCIExyYTRIPLE kP3{{0.680, 0.320, 1}, {0.265, 0.690, 1}, {0.150, 0.060, 1}};

// 3 x 2 pixels, all different.
Image pattern() {
  Image out(3, 2, 3);
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = uint8_t(10 * i);
  return out;
}

CaptureCamera calibratedFor(int width, int height, Orientation orientation = Orientation::BySize) {
  CaptureCamera camera;
  camera.pinhole.name = "cam00";
  camera.pinhole.width = width, camera.pinhole.height = height;
  camera.orientation = orientation;
  return camera;
}

// EXIF 2.3: displayed sides of the stored picture's row 0 and column 0.
TEST(Upright, EightOrientationsOfExif) {
  const char* kRow0[] = {"top", "top", "bottom", "bottom", "left", "right", "right", "left"};
  const char* kColumn0[] = {"left", "right", "right", "left", "top", "top", "bottom", "bottom"};
  const TempFolder folder;
  for (const bool big_endian : {false, true}) {
    for (int orientation = 1; orientation <= 8; ++orientation) {
      folder.write("a.png", pattern());
      addChunk(folder / "a.png", "eXIf", exif(orientation, big_endian));
      PictureMarks marks;
      const Image stored = readPicture(folder / "a.png", 3, &marks).value(), shown = applyMarks(stored, marks);
      const std::string row0 = kRow0[orientation - 1], column0 = kColumn0[orientation - 1];
      for (int row = 0; row < 2; ++row) {
        for (int column = 0; column < 3; ++column) {
          int x = 0, y = 0;
          if (row0 == "top") y = row;
          if (row0 == "bottom") y = 1 - row;
          if (row0 == "left") x = row;
          if (row0 == "right") x = 1 - row;
          if (column0 == "left") x = column;
          if (column0 == "right") x = 2 - column;
          if (column0 == "top") y = column;
          if (column0 == "bottom") y = 2 - column;
          EXPECT_EQ(*shown.at(x, y), *stored.at(column, row)) << orientation << ": " << row << ", " << column;
        }
      }
    }
  }
}

TEST(Upright, JpegSegmentsAreRead) {
  const std::string segment = std::string("Exif\0\0", 6) + exif(6, true), profile = profileOf(kP3, 2.2);
  std::string jpeg = "\xff\xd8\xff\xe1" + bigEndian(uint32_t(segment.size() + 2), 2) + segment;
  for (const int part : {2, 1}) {  // parts have numbers, and need not be in order
    const size_t half = profile.size() / 2;
    const std::string data = std::string("ICC_PROFILE\0", 12) + char(part) + '\x02' +
                             (part == 1 ? profile.substr(0, half) : profile.substr(half));
    jpeg += "\xff\xe2" + bigEndian(uint32_t(data.size() + 2), 2) + data;
  }
  const StillMarks found = stillMarks(jpeg + "\xff\xda");
  EXPECT_EQ(found.marks.quarter_turns, 1);
  EXPECT_EQ(found.profile, profile);
}

TEST(Upright, DamagedMarksAreNone) {
  const std::string segment = std::string("Exif\0\0", 6) + exif(6, true);
  const std::string jpeg = "\xff\xd8\xff\xe1" + bigEndian(uint32_t(segment.size() + 2), 2) + segment + "\xff\xda";
  EXPECT_EQ(stillMarks(jpeg).marks.quarter_turns, 1);
  for (size_t length = 0; length < 30; ++length) EXPECT_FALSE(stillMarks(jpeg.substr(0, length)).marks.turns());
  EXPECT_FALSE(stillMarks("\xff\xd8\xff\xe1\xff\xff").marks.turns());
  Image image = pattern();
  toSrgb("no profile", image);
  EXPECT_EQ(image.pixels, pattern().pixels);
}

TEST(Upright, TheCalibratedSizeDecides) {
  const PictureMarks quarter{false, 1};
  EXPECT_EQ(asCalibrated(pattern(), quarter, calibratedFor(3, 2), "a").value().pixels, pattern().pixels);
  const Image turned = asCalibrated(pattern(), quarter, calibratedFor(2, 3), "a").value();
  EXPECT_EQ(turned.width, 2);
  EXPECT_EQ(*turned.at(1, 0), *pattern().at(0, 0));
  const auto neither = asCalibrated(pattern(), quarter, calibratedFor(5, 5), "a.mp4");
  expectError(neither, ErrorId::FrameSize, "a.mp4: 3x2 pixels, marked as turned by 90°, but camera cam00");
}

TEST(Upright, WhereBothSizesFitTheUserDecides) {
  const PictureMarks half{false, 2};
  expectError(asCalibrated(pattern(), half, calibratedFor(3, 2), "a.mp4"), ErrorId::FrameSize, "--orientation marked");
  const auto as = [&](Orientation orientation) {
    return *asCalibrated(pattern(), half, calibratedFor(3, 2, orientation), "a.mp4").value().at(0, 0);
  };
  EXPECT_EQ(as(Orientation::Stored), *pattern().at(0, 0));
  EXPECT_EQ(as(Orientation::Marked), *pattern().at(2, 1));
}

TEST(Upright, PixelsThatAreNotSquareAreStretchedIfTheCalibrationIs) {
  const PictureMarks wide{false, 0, 4.0 / 3}, narrow{false, 0, 0.5};
  EXPECT_EQ(asCalibrated(pattern(), wide, calibratedFor(3, 2), "a").value().pixels, pattern().pixels);
  EXPECT_EQ(asCalibrated(pattern(), wide, calibratedFor(4, 2), "a").value().width, 4);
  EXPECT_EQ(asCalibrated(pattern(), narrow, calibratedFor(3, 4), "a").value().height, 4);
  const PictureMarks both{false, 3, 4.0 / 3};
  EXPECT_EQ(asCalibrated(pattern(), both, calibratedFor(2, 4), "a").value().height, 4);
}

TEST(Upright, ProfilesBecomeSrgb) {
  const TempFolder folder;
  folder.write("a.png", Image(4, 4, 3, 120));
  folder.write("b.png", Image(4, 4, 3, 120));
  addChunk(folder / "a.png", "iCCP", std::string("P3\0\0", 4) + deflated(profileOf(kP3, 1.8)));
  const Image converted = readPicture(folder / "a.png", 3).value(), plain = readPicture(folder / "b.png", 3).value();
  EXPECT_EQ(*plain.at(1, 1), 120);
  const double light = std::pow(120 / 255.0, 1.8), srgb = 255 * (1.055 * std::pow(light, 1 / 2.4) - 0.055);
  EXPECT_NEAR(*converted.at(1, 1), srgb, 1.5);  // grey has no primaries
  std::string name;
  EXPECT_TRUE(changesColours(profileOf(kP3, 2.2), &name));
}

TEST(Upright, ProfilesOfSrgbChangeNothing) {
  cmsHPROFILE srgb = cmsCreate_sRGBProfile();
  cmsUInt32Number bytes = 0;
  cmsSaveProfileToMem(srgb, nullptr, &bytes);
  std::string profile(bytes, '\0');
  cmsSaveProfileToMem(srgb, profile.data(), &bytes);
  cmsCloseProfile(srgb);
  EXPECT_FALSE(changesColours(profile));
  Image image = pattern();
  toSrgb(profile, image);
  EXPECT_EQ(image.pixels, pattern().pixels);
}

// Frames, plates and mattes of a camera alike.
TEST(Upright, CapturesAreReadAsTheyAreCalibrated) {
  SmallCapture capture;
  Image stored(12, 16, 3, 50);
  *stored.at(0, 0) = 200;
  for (int frame = 0; frame < SmallCapture::kFrames; ++frame) {
    const std::string name = "walk/cam01/" + numbered(frame, ".png");
    capture.write(name, stored);
    addChunk(capture / name, "eXIf", exif(6, false));
  }
  const auto opened = capture.open();
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  auto reader = mattes::FrameReader::open(opened.value(), opened.value().sequences[0], platform::openVideoFile);
  ASSERT_TRUE(reader.ok());
  const mattes::CaptureFrame frame = reader.value()->next().take();
  EXPECT_EQ(frame.pictures[1].width, 16);
  EXPECT_EQ(*frame.pictures[1].at(15, 0), 200);  // the first row is displayed at the right
}

TEST(Upright, CaptureJsonDecides) {
  SmallCapture capture;
  for (int frame = 0; frame < SmallCapture::kFrames; ++frame)
    addChunk(capture / ("walk/cam01/" + numbered(frame, ".png")), "eXIf", exif(3, false));
  expectError(capture.open(), ErrorId::FrameSize, "cam01");
  std::string json = capture.json();
  capture.write("capture.json", json.insert(1, R"("calibration": {"orientation": "stored"}, )"));
  EXPECT_TRUE(capture.open().ok());
  capture.write("capture.json", capture.json().insert(1, R"("calibration": {"orientation": "sideways"}, )"));
  expectError(capture.open(), ErrorId::CaptureJson, "orientation");
}

TEST(PictureReport, NamesMarksAndTheSourceOfMattes) {
  SmallCapture capture;
  addChunk(capture / "walk/cam01/000000.png", "eXIf", exif(6, false));
  const Capture opened = openDescription(capture.path(), {}, MeshNeed::Nothing).take();
  const auto report = [&](size_t camera) {
    return reportOnPictures(opened.sequences[0], opened.cameras[camera], platform::openVideoFile).value();
  };
  EXPECT_EQ(report(0).done, std::vector<std::string>());
  EXPECT_EQ(report(0).width, 16);
  EXPECT_EQ(report(1).done, std::vector<std::string>{"not turned by 90°: the calibration is of stored pictures"});
  const auto mattes = [&] {
    return matteSource(opened, opened.sequences[0], opened.cameras[0], platform::openVideoFile);
  };
  EXPECT_EQ(mattes(), "walk/mask00/%06d.png");
  capture.remove("walk/mask00");
  EXPECT_EQ(mattes(), "none");
  capture.write("background/cam00.png", SmallCapture::grey(3));
  EXPECT_EQ(mattes(), "keyed against background/cam00.png");
}

TEST(PictureReport, CountsPicturesOfAVideo) {
  const Capture sample = openDescription(kSample, {"walk"}, MeshNeed::Nothing).take();
  const PictureReport report =
      reportOnPictures(sample.sequences[0], sample.cameras[0], platform::openVideoFile).value();
  EXPECT_EQ(report.pictures, 28u);
  EXPECT_EQ(report.done, std::vector<std::string>());
}

}  // namespace
}  // namespace fourdvt::capture

// SPDX-License-Identifier: Apache-2.0
// Imports a folder with a calibration and pictures into a capture that opens; reports missing and mismatched files.
#include "capture/import/import_capture.h"

#include "capture/import/readers.h"
#include "import_fixture.h"
#include "mattes/frame_reader.h"
#include "png_marks.h"

namespace fourdvt::capture {
namespace {

// Two cameras of 16x12 with pictures of different greys; the file's world has −Z up, in millimetres.
class ImportFolder : public TempFolder {
 public:
  ImportFolder() {
    for (int c = 1; c <= 2; ++c) {
      const std::string cam = "in/cam" + std::to_string(c) + "/";
      write(cam + "config.yml", camera(c));
      for (int frame = 0; frame < 3; ++frame)
        write(cam + "shot_" + std::to_string(frame + 8) + ".png", grey(20 * c + frame));
      write(cam + "background.png", grey(20 * c));
    }
    options.source = *this / "in";
    options.folder = *this / "out";
    options.up = WorldAxis::MinusZ;
    options.metres_per_unit = 0.001;
    options.fps = 30;
  }
  static std::string camera(int c) {
    return "K: [20, " + std::to_string(c - 1) + ", 7.5, 0, 21, 5.5, 0, 0, 1]\nD: [0.1, 0, 0, 0]\nR: [0, 0, 0.1]\nT: [" +
           std::to_string(1000 * c) + ", 0, 3000]\n";
  }
  static Image grey(int level, int width = 16, int height = 12) {
    return Image(width, height, 3, static_cast<uint8_t>(level));
  }
  Result<ImportSummary> run() const { return importCapture(options, platform::openVideoFile); }
  Result<Capture> open() const {
    return mattes::openCapture(options.folder, platform::openVideoFile, {}, MeshNeed::Nothing);
  }
  ImportOptions options;
};

bool mentions(const std::vector<std::string>& lines, const std::string& a, const std::string& b = "") {
  for (const std::string& line : lines)
    if (line.find(a) != std::string::npos && line.find(b) != std::string::npos) return true;
  return false;
}

TEST(ImportCapture, OpensAsACapture) {
  const ImportFolder files;
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(mentions(summary.value().done, "-Z becomes Y"));
  EXPECT_TRUE(mentions(summary.value().done, "0.001 m"));
  EXPECT_TRUE(mentions(summary.value().done, "plates of 2 cameras"));
  EXPECT_TRUE(summary.value().warnings.empty()) << summary.value().warnings[0];
  auto opened = files.open();
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  const Capture& capture = opened.value();
  EXPECT_EQ(capture.fps, 30);
  ASSERT_EQ(capture.sequences.size(), 1u);
  EXPECT_EQ(capture.sequences[0].name, "take");
  EXPECT_EQ(capture.sequences[0].frame_count, 3u);
  ASSERT_EQ(capture.cameras.size(), 2u);
  EXPECT_EQ(capture.cameras[1].pinhole.width, 16);
  EXPECT_EQ(capture.cameras[0].distortion.skew, 0);
  EXPECT_EQ(capture.cameras[1].distortion.skew, 1);
  auto reader = mattes::FrameReader::open(capture, capture.sequences[0], platform::openVideoFile);
  ASSERT_TRUE(reader.ok()) << reader.error().message;
  for (int frame = 0; frame < 3; ++frame) {
    auto pictures = reader.value()->next();
    ASSERT_TRUE(pictures.ok()) << pictures.error().message;
    EXPECT_EQ(pictures.value().pictures[1].at(8, 6)[0], 40 + frame) << "in the order of their numbers, 8, 9, 10";
  }
}

// (x, y, z) in the file, millimetres with −z up, becomes (x, −z, y) in metres.
TEST(ImportCapture, TurnsAndScalesTheWorld) {
  const ImportFolder files;
  ASSERT_TRUE(files.run().ok());
  auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  for (int c = 1; c <= 2; ++c) {
    for (const Vector& p : kPoints) {
      const Vector seen =
          plus(times(rodrigues({0, 0, 0.1}), {1000 * p[0], 1000 * p[1], 1000 * p[2]}), {1000.0 * c, 0, 3000});
      const glm::dvec2 expected = throughLens({20, 21, 8, 6, c - 1.0, {0.1}}, seen);
      const CaptureCamera& camera = capture.value().cameras[c - 1];
      const glm::dvec2 got = filmedPixel(camera, glm::dvec2(camera.pinhole.project({p[0], -p[2], p[1]})));
      EXPECT_NEAR(got.x, expected.x, 0.01);
      EXPECT_NEAR(got.y, expected.y, 0.01);
    }
  }
}

TEST(ImportCapture, SaysWhatItDidNotFind) {
  ImportFolder files;
  for (const char* shot : {"shot_8.png", "shot_9.png", "shot_10.png", "background.png"})
    files.remove(std::string("in/cam2/") + shot);
  files.write("in/cam7/0.png", ImportFolder::grey(1));
  files.options.up.reset();
  files.options.fps = 0;
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  const auto& warnings = summary.value().warnings;
  EXPECT_TRUE(mentions(warnings, "camera cam2: no video and no pictures"));
  EXPECT_TRUE(mentions(warnings, "in/cam7: no camera of the calibration has this name"));
  EXPECT_TRUE(mentions(warnings, "no axis that is up"));
  EXPECT_TRUE(mentions(warnings, "25 frames a second are assumed"));
  auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture.value().cameras.size(), 1u);
}

TEST(ImportCapture, AllCamerasMissingIsAnError) {
  ImportFolder files;
  files.options.sequences = {{"walk", "nowhere"}};
  expectError(files.run(), ErrorId::CameraMissingVideo, "cam1, cam2");
  EXPECT_FALSE(std::filesystem::exists(files.options.folder));
}

TEST(ImportCapture, AnotherSizeNamesBoth) {
  ImportFolder files;
  std::string sized = "image_width: 18\nimage_height: 12\n" + ImportFolder::camera(1);
  files.write("in/cam1/config.yml", sized);
  expectError(files.run(), ErrorId::FrameSize, "16x12 pixels, but camera cam1 is calibrated for 18x12");
  files.options.cropped = true;
  ASSERT_TRUE(files.run().ok());
  EXPECT_EQ(files.open().value().cameras[0].pinhole.width, 16);
  files.remove("out");
  files.write("in/cam1/config.yml", "image_width: 15\nimage_height: 12\n" + ImportFolder::camera(1));
  expectError(files.run(), ErrorId::FrameSize, "16x12 pixels, but camera cam1 is calibrated for 15x12");
  files.write("in/cam1/config.yml", ImportFolder::camera(1));
  files.write("in/cam2/background.png", ImportFolder::grey(1, 12, 16));
  expectError(files.run(), ErrorId::FrameSize, "background.png");
  EXPECT_FALSE(std::filesystem::exists(files.options.folder));
  EXPECT_FALSE(std::filesystem::exists(files.options.folder + ".part"));
}

TEST(ImportCapture, SequencesHaveFoldersAndMattes) {
  ImportFolder files;
  for (int frame = 0; frame < 2; ++frame) {
    for (const char* name : {"cam1", "cam2"}) {
      const std::string number = std::to_string(frame) + ".jpg";
      files.write(std::string("in/run/images/") + name + "/" + number, ImportFolder::grey(99));
      files.write(std::string("in/run/masks/") + name + "/" + std::to_string(frame) + ".png", framedMatte(16, 12));
    }
  }
  files.options.sequences = {{"stand", "."}, {"run", "run"}};
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(mentions(summary.value().done, "sequence run: 2 frames, 2 cameras with mattes"));
  auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture.value().find("run")->frame_count, 2u);
  EXPECT_TRUE(std::filesystem::is_symlink(files.options.folder + "/run/cam1/000001.jpg"));
  EXPECT_TRUE(std::filesystem::is_symlink(files.options.folder + "/run/mask2/000001.png"));
}

// Equal warnings of two cameras become one line.
TEST(ImportCapture, SameWarningsAreOne) {
  ImportFolder files;
  for (const char* name : {"in/cam1/background.png", "in/cam2/background.png"}) files.remove(name);
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(mentions(summary.value().warnings, "cameras cam1, cam2: no mattes and no plates"));
  EXPECT_EQ(summary.value().warnings.size(), 1u);
}

// Mattes beside the pictures, and test pictures, count as used.
TEST(ImportCapture, FilesThatAreUsedGiveNoWarning) {
  ImportFolder files;
  files.options.source = kSample;
  files.options.up = WorldAxis::Y;
  files.options.metres_per_unit.reset();
  files.options.fps = 0;
  files.options.sequences = {{"walk", "walk"}};
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_EQ(summary.value().warnings, std::vector<std::string>{});
  EXPECT_TRUE(mentions(summary.value().done, "8 cameras with mattes"));
}

// Cut-outs: the pictures' alpha is the matte.
TEST(ImportCapture, AlphaOfPicturesIsAMatte) {
  ImportFolder files;
  Image cut_out = Image(16, 12, 4, 90);
  for (int x = 3; x < 9; ++x) cut_out.at(x, 5)[3] = 255;
  for (const char* name : {"in/cam1/background.png", "in/cam2/background.png"}) files.remove(name);
  for (int frame = 8; frame < 11; ++frame)
    for (const char* camera : {"in/cam1/shot_", "in/cam2/shot_"})
      files.write(camera + std::to_string(frame) + ".png", cut_out);
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_EQ(summary.value().warnings, std::vector<std::string>{});
  EXPECT_TRUE(mentions(summary.value().done, "2 with mattes in their alpha"));
  EXPECT_TRUE(mattes::openCapture(files.options.folder, platform::openVideoFile, {}, MeshNeed::Nothing).ok());
}

// The message names the user's clip, not the link to it.
TEST(ImportCapture, AlphaThatDoesNotDecodeIsRefused) {
  struct Clip final : VideoSource {
    Result<std::optional<Image>> next() override {
      return left-- > 0 ? std::optional<Image>(ImportFolder::grey(90)) : std::nullopt;
    }
    Result<VideoListing> list() override { return VideoListing{3, 3, false, {}, 0, {}, {}, {}, {}, {}}; }
    bool hasAlpha() const override { return true; }
    int left = 3;
  };
  const OpenVideo video = [](const std::string& path, int channels) -> Result<std::unique_ptr<VideoSource>> {
    if (channels != 3) return Error{ErrorId::FileUnreadable, path + ": alpha is not decoded; export it again"};
    return std::unique_ptr<VideoSource>(std::make_unique<Clip>());
  };
  ImportFolder files;
  for (const char* name : {"cam1", "cam2"}) {
    for (const char* frame : {"8", "9", "10"}) files.remove(std::string("in/") + name + "/shot_" + frame + ".png");
    files.write(std::string("in/") + name + "/clip.mov", std::string("x"));
  }
  expectError(importCapture(files.options, video), ErrorId::FileUnreadable, files / "in/cam1/clip.mov: alpha is not");
}

TEST(ImportCapture, FoldersInUseStay) {
  ImportFolder files;
  files.write("out/precious.txt", std::string("mine"));
  expectError(files.run(), ErrorId::InvalidArgument, "exists already");
  EXPECT_TRUE(std::filesystem::exists(files / "out/precious.txt"));
  for (const auto& [name, folder] : {std::pair{"", "a"}, {"a/b", "c"}, {"cameras", "a"}, {"x", ""}}) {
    files.options.sequences = {{name, folder}};
    EXPECT_NE(files.options.check(), "") << name;
  }
  files.options.sequences = {{"a", "x"}, {"a", "y"}};
  EXPECT_NE(files.options.check(), "");
}

TEST(ImportFiles, UnknownKindsListTheKnownOnes) {
  const TempFolder files;
  files.write("in/calibration.dat", std::string("what is this"));
  files.write("in/notes.json", std::string("{\"a\": 1}"));
  for (const char* source : {"in", "in/calibration.dat"}) {
    auto read = readCalibration(files / source);
    expectError(read, ErrorId::FileUnreadable, "known are COLMAP");
    if (read.ok()) continue;
    for (const char* kind : {"nerfstudio", "EasyMocap", "ActorsHQ", "Qualisys", "Pose2Sim", "OpenCV", "projection"})
      EXPECT_NE(read.error().message.find(kind), std::string::npos) << read.error().message;
  }
  expectError(readCalibration(files / "none"), ErrorId::FileMissing, "none");
}

TEST(ImportFiles, EveryKindIsFoundInItsFolder) {
  const TempFolder files;
  const std::string camera = ImportFolder::camera(1);
  const auto kindOf = [&](const std::string& folder) {
    auto read = readCalibration(files / folder);
    EXPECT_TRUE(read.ok()) << (read.ok() ? "" : read.error().message);
    return read.ok() ? read.value().kind + " " + read.value().cameras[0].camera.pinhole.name : "";
  };
  files.write("a/sparse/0/cameras.txt", std::string("1 PINHOLE 16 12 20 20 8 6\n"));
  files.write("a/sparse/0/images.txt", std::string("1 1 0 0 0 0 0 3 1 left.png\n\n"));
  EXPECT_EQ(kindOf("a"), "COLMAP left");
  files.write("b/transforms.json", std::string(R"({"fl_x": 20, "cx": 8, "cy": 6, "frames": [
    {"file_path": "cam01/0.png", "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,3],[0,0,0,1]]},
    {"file_path": "cam02/0.png", "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,3],[0,0,0,1]]}]})"));
  EXPECT_EQ(kindOf("b"), "nerfstudio cam01");
  files.write("c/intri.yml", std::string("K_1: [20, 0, 8, 0, 20, 6, 0, 0, 1]\n"));
  files.write("c/extri.yml", std::string("names: [\"1\"]\nR_1: [0, 0, 0.1]\nT_1: [0, 0, 3]\n"));
  EXPECT_EQ(kindOf("c"), "EasyMocap 1");
  EXPECT_EQ(kindOf("c/extri.yml"), "EasyMocap 1");
  files.write("d/calibration.csv",
              std::string("name,w,h,rx,ry,rz,tx,ty,tz,fx,fy,px,py\nC,16,12,0,0,0,0,0,0,1,1,.5,.5\n"));
  EXPECT_EQ(kindOf("d"), "ActorsHQ C");
  files.write("e/Config.toml", std::string("[project]\nx = 1\n"));
  files.write("e/Second.toml", std::string("[c1]\nmatrix = [[20,0,8],[0,20,6],[0,0,1]]\nrotation = [0,0,0]\n"
                                           "translation = [0,0,3]\n"));
  EXPECT_EQ(kindOf("e"), "Pose2Sim or Caliscope c1");
  files.write("f/left.yml", camera);
  files.write("f/right.yml", camera);
  EXPECT_EQ(kindOf("f"), "OpenCV FileStorage left");
  files.write("g/calibration/v0.txt", std::string("20 0 8 0 0 20 6 0 0 0 1 3\n"));
  files.write("g/readme.txt", std::string("hello\n"));
  EXPECT_EQ(kindOf("g"), "projection matrices v0");
}

TEST(ImportFiles, OneBrokenFileAmongGoodOnesIsNotLeftOut) {
  const ImportFolder files;
  files.write("in/cam2/config.yml", std::string("K: [20, 0, 8"));
  expectError(readCalibration(files.options.source), ErrorId::FileUnreadable, "cam2/config.yml");
}

TEST(ImportFiles, HugeFilesAreNotRead) {
  const TempFolder files;
  files.write("in/c.qca.txt", std::string("<"));
  std::filesystem::resize_file(files / "in/c.qca.txt", (64ull << 20) + 1);
  expectError(readCalibration(files / "in"), ErrorId::FileUnreadable, "64 MB");
}

TEST(ImportFiles, ManyCamerasAreRead) {
  const TempFolder files;
  std::string text = "name,w,h,rx,ry,rz,tx,ty,tz,fx,fy,px,py\n";
  for (int c = 0; c < 128; ++c) {
    text += "C";
    text += std::to_string(c) + ",16,12,0," + std::to_string(0.01 * c) + ",0,0,0,0,1,1,.5,.5\n";
  }
  files.write("calibration.csv", text);
  auto read = readCalibration(files.path());
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read.value().cameras.size(), 128u);
  files.write("calibration.csv", text + "C5,16,12,0,0,0,0,0,0,1,1,.5,.5\n");
  expectError(readCalibration(files.path()), ErrorId::CameraPose, "\"C5\" is listed twice");
  files.write("calibration.csv", text + "../x,16,12,0,0,0,0,0,0,1,1,.5,.5\n");
  expectError(readCalibration(files.path()), ErrorId::CameraPose, "../x");
}

// cam1 lies upside down, cam2 does not.
TEST(ImportCapture, PicturesThatAreMarkedAsTurned) {
  ImportFolder files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(files / "in/cam1"))
    if (entry.path().extension() == ".png") addChunk(entry.path().string(), "eXIf", exif(3, false));
  expectError(files.run(), ErrorId::FrameSize, "give fourdvt import --orientation marked");
  files.options.orientation = Orientation::Marked;
  const auto marked = files.run();
  ASSERT_TRUE(marked.ok()) << marked.error().message;
  EXPECT_TRUE(mentions(marked.value().done, "pictures of cam1: turned by 180°"));
  EXPECT_EQ(files.open().value().cameras[0].orientation, Orientation::Marked);
  files.remove("out");
  files.options.orientation = Orientation::Stored;
  EXPECT_TRUE(mentions(files.run().value().done, "pictures of cam1: not turned by 180°"));
  EXPECT_EQ(files.open().value().cameras[0].orientation, Orientation::Stored);
}

}  // namespace
}  // namespace fourdvt::capture

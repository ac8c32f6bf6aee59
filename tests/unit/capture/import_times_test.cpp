// SPDX-License-Identifier: Apache-2.0
// Matching of pictures at import by time stamps, time codes and numbers; messages name what a camera lacks.
#include "capture/import/import_capture.h"
#include "capture_fixture.h"
#include "clip_files.h"
#include "mattes/frame_reader.h"

namespace fourdvt::capture {
namespace {

// Cameras cam0, cam1, cam2 of 16x12; a test adds their clips.
class TimedFolder : public TempFolder {
 public:
  TimedFolder() {
    for (int c = 0; c < 3; ++c)
      write("in/cam" + std::to_string(c) + ".yml",
            "K: [20, 0, 7.5, 0, 20, 5.5, 0, 0, 1]\nD: [0, 0, 0, 0]\nR: [0, 0, 0.1]\nT: [" + std::to_string(c) +
                ", 0, 3]\n");
    options.source = *this / "in";
    options.folder = *this / "out";
    options.up = WorldAxis::Y;
    options.metres_per_unit = 1;
  }
  void clips(const ClipFile& clip, const std::string& ending = ".mp4") const {
    for (int c = 0; c < 3; ++c) writeClip(*this / ("in/cam" + std::to_string(c) + ending), clip);
  }
  // Writes pictures of grey 10 × number, or mattes with this value at (3, 3); omits `without`.
  void pictures(const std::string& folder, int first, int end, int without = -1, int channels = 3) const {
    for (int i = first; i < end; ++i)
      if (i != without)
        write(folder + "/" + numbered(i, ".png"),
              channels == 1 ? matteWith(uint8_t(10 * i), 16, 12) : Image(16, 12, channels, uint8_t(10 * i)));
  }
  Result<ImportSummary> run() {
    std::filesystem::remove_all(options.folder);
    auto summary = importCapture(options, platform::openVideoFile);
    if (summary.ok()) done = summary.value().done, warnings = summary.value().warnings;
    return summary;
  }
  // [camera] greys of the frames, divided by 10; empty: an error.
  std::vector<std::vector<int>> greys(MatteNeed need = MatteNeed::None) const {
    auto capture = mattes::openCapture(options.folder, platform::openVideoFile, {}, MeshNeed::Nothing, need);
    EXPECT_TRUE(capture.ok()) << (capture.ok() ? "" : capture.error().message);
    if (!capture.ok()) return {};
    std::vector<std::vector<int>> out(capture.value().cameras.size());
    auto reader =
        mattes::FrameReader::open(capture.value(), capture.value().sequences[0], platform::openVideoFile, 0, need);
    for (uint32_t f = 0; f < capture.value().sequences[0].frame_count; ++f) {
      const auto frame = reader.value()->next();
      EXPECT_TRUE(frame.ok()) << (frame.ok() ? "" : frame.error().message);
      if (!frame.ok()) return {};
      for (size_t c = 0; c < out.size(); ++c)
        out[c].push_back((frame.value().pictures[c].at(3, 3)[need == MatteNeed::None ? 0 : 3] + 5) / 10);
    }
    return out;
  }
  bool says(const std::vector<std::string>& lines, const std::string& a, const std::string& b = "") const {
    for (const std::string& line : lines)
      if (line.find(a) != std::string::npos && line.find(b) != std::string::npos) return true;
    return false;
  }
  std::string all() const {
    std::string out;
    for (const auto& line : warnings) out += line + "\n";
    return out;
  }
  ImportOptions options;
  std::vector<std::string> done, warnings;
};

using Greys = std::vector<std::vector<int>>;

double lostAt3(int i) { return (i < 3 ? i : i + 1) / 25.0; }  // omits picture 3 of the others
int greyWithout3(int i) { return 10 * (i < 3 ? i : i + 1); }

TEST(ImportTimes, AClipThatLacksAPictureIsNamedAndTheTakeIsCut) {
  for (const char* ending : {".mp4", ".mkv"}) {
    TimedFolder files;
    files.clips({.pictures = 9}, ending);
    writeClip(files / (std::string("in/cam1") + ending), {.pictures = 8, .time_s = lostAt3, .grey = greyWithout3});
    ASSERT_TRUE(files.run().ok());
    EXPECT_TRUE(files.says(files.warnings,
                           std::string("in/cam1") + ending + ": lacks a picture at 0.120 s (after picture 2)",
                           "ffmpeg -noautorotate -i cam1"))
        << files.all();
    EXPECT_TRUE(files.says(files.warnings, "5 of 9 frames are kept")) << files.all();
    const std::vector<int> kept{4, 5, 6, 7, 8};
    EXPECT_EQ(files.greys(), (Greys{kept, kept, kept}));
  }
}

TEST(ImportTimes, CapturesWithSuchAClipAreRefusedByHand) {
  TimedFolder files;
  files.clips({.pictures = 9});
  ASSERT_TRUE(files.run().ok());
  files.remove("in/cam1.mp4");
  writeClip(files / "in/cam1.mp4", {.pictures = 9, .time_s = lostAt3, .grey = greyWithout3});
  const auto open = [&] {
    return mattes::openCapture(files.options.folder, platform::openVideoFile, {}, MeshNeed::Nothing, MatteNeed::None);
  };
  expectError(open(), ErrorId::VideoTooShort, "take/cam1.mp4: lacks a picture at 0.120 s, after picture 2");
  for (const char* name : {"in/cam0.mp4", "in/cam2.mp4"}) {
    files.remove(name);
    writeClip(files / name, {.pictures = 9, .time_s = lostAt3});
  }
  EXPECT_TRUE(open().ok()) << "all lack it: the pictures are in step";
}

TEST(ImportTimes, MattesGoWithTheirPictures) {
  TimedFolder files;
  files.clips({.pictures = 9});
  writeClip(files / "in/cam1.mp4", {.pictures = 8, .time_s = lostAt3, .grey = greyWithout3});
  for (int c = 0; c < 3; ++c) {
    const bool lost = c == 1;
    const auto grey = [lost](int i) { return 100 + (lost ? greyWithout3(i) : 10 * i); };
    writeClip(files / ("in/mask" + std::to_string(c) + ".mkv"),
              {.pictures = lost ? 8 : 9,
               .channels = 1,
               .time_s = lost ? lostAt3 : std::function<double(int)>(),
               .grey = grey});
  }
  ASSERT_TRUE(files.run().ok());
  const std::vector<int> kept{14, 15, 16, 17, 18};
  EXPECT_EQ(files.greys(MatteNeed::Required), (Greys{kept, kept, kept}));
}

TEST(ImportTimes, TimecodesOffsetClips) {
  TimedFolder files;
  files.clips({.pictures = 9, .timecode = "23:59:59:24"}, ".mov");
  files.remove("in/cam1.mov");
  writeClip(files / "in/cam1.mov",
            {.pictures = 9, .grey = [](int i) { return 10 * (i + 2); }, .timecode = "00:00:00:01"});
  ASSERT_TRUE(files.run().ok());
  EXPECT_TRUE(files.says(files.done, "time codes", "cam1 by 2")) << files.all();
  const std::vector<int> kept{2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(files.greys(), (Greys{kept, kept, kept}));
  files.options.ignore_time_codes = true;
  ASSERT_TRUE(files.run().ok());
  EXPECT_EQ(files.greys()[1][0], 2);
  files.options.ignore_time_codes = false;
  files.remove("in/cam2.mov");
  writeClip(files / "in/cam2.mov", {.pictures = 9});
  ASSERT_TRUE(files.run().ok());
  EXPECT_TRUE(files.says(files.warnings, "time codes are not used", "cam2 has none")) << files.all();
  writeClip(files / "in/cam2.mov", {.pictures = 9, .timecode = "11:00:00:00"});
  ASSERT_TRUE(files.run().ok());
  EXPECT_TRUE(files.says(files.warnings, "no instant is in all clips")) << files.all();
}

TEST(ImportTimes, CreationTimesAreAHint) {
  TimedFolder files;
  files.clips({.pictures = 5, .created = "2024-05-01T10:00:00.000000Z"});
  ASSERT_TRUE(files.run().ok());
  EXPECT_FALSE(files.says(files.done, "creation_time"));
  writeClip(files / "in/cam2.mp4", {.pictures = 5, .created = "2024-05-01T10:00:03.000000Z"});
  ASSERT_TRUE(files.run().ok());
  EXPECT_TRUE(files.says(files.done, "creation_time, a hint that is not used", "cam2"));
  EXPECT_EQ(files.greys()[2], (std::vector<int>{0, 1, 2, 3, 4}));
}

TEST(ImportTimes, VariableAndDifferentRatesAreRefusedWithTheCommand) {
  TimedFolder files;
  files.clips({.pictures = 12});
  const auto uneven = [](int i) { return i / 25.0 + (i % 2) * 0.02; };
  writeClip(files / "in/cam1.mp4", {.pictures = 12, .time_s = uneven});
  expectError(files.run(), ErrorId::FileUnreadable, "in/cam1.mp4: its frame rate varies");
  expectError(files.run(), ErrorId::FileUnreadable, "-i cam1.mp4 -vf fps=25");
  writeClip(files / "in/cam1.mp4", {.pictures = 12, .fps = 50});
  expectError(files.run(), ErrorId::FileUnreadable, "in/cam1.mp4: 50 frames a second, but");
  writeClip(files / "in/cam1.mp4", {.pictures = 12, .time_s = [](int i) { return i / 25.0 + (i % 2) * 0.01; }});
  ASSERT_TRUE(files.run().ok()) << "a quarter of a frame";
  EXPECT_TRUE(files.says(files.done, "in/cam1.mp4: its pictures lie up to 0.2"));
}

TEST(ImportTimes, FoldersArePairedByTheirNumbers) {
  TimedFolder files;
  for (const char* cam : {"in/cam0", "in/cam2"}) files.pictures(cam, 0, 8);
  files.pictures("in/cam1", 1, 9);
  ASSERT_TRUE(files.run().ok());
  EXPECT_TRUE(files.says(files.warnings, "in/cam1: begins with cam1/000001.png, others with cam0/000000.png"))
      << files.all();
  const std::vector<int> kept{1, 2, 3, 4, 5, 6, 7};
  EXPECT_EQ(files.greys(), (Greys{kept, kept, kept}));
}

// Meshes of all instants start with the first picture common to all cameras.
TEST(ImportTimes, MeshesGoWithTheirPictures) {
  TimedFolder files;
  for (int c = 0; c < 3; ++c) files.pictures("in/cam" + std::to_string(c), c == 1 ? 3 : 0, 9);
  for (int f = 0; f < 9; ++f) files.write("in/mesh/" + numbered(f, ".obj"), quadObj(f));
  ASSERT_TRUE(files.run().ok());
  const std::string first = files.options.folder + "/take/mesh/000000.obj";
  EXPECT_EQ(std::filesystem::canonical(first).filename(), "000003.obj");
  files.remove("in/mesh/000008.obj");
  expectError(files.run(), ErrorId::FileMissing, "in/mesh/000008.obj");
}

TEST(ImportTimes, AMissingPictureOrMatteIsNamed) {
  for (const bool of_mattes : {false, true}) {
    TimedFolder files;
    for (int c = 0; c < 3; ++c) {
      const std::string number = std::to_string(c);
      files.pictures("in/cam" + number, 0, 8, c == 1 && !of_mattes ? 3 : -1);
      files.pictures("in/masks/cam" + number, 0, 8, c == 1 ? 3 : -1, 1);
    }
    ASSERT_TRUE(files.run().ok());
    EXPECT_TRUE(of_mattes ? files.says(files.warnings, "in/masks/cam1: lacks the matte of cam1/000003.png")
                          : files.says(files.warnings, "in/cam1: lacks the picture that", "/000003.png"))
        << files.all();
    EXPECT_TRUE(files.says(files.warnings, "4 of 8 frames are kept")) << files.all();
    const std::vector<int> kept{4, 5, 6, 7};
    EXPECT_EQ(files.greys(), (Greys{kept, kept, kept}));
    EXPECT_EQ(files.greys(MatteNeed::Required), (Greys{kept, kept, kept}));
  }
}

// The other numbers reveal the missing one.
TEST(ImportTimes, AMissingFirstMatteOfAVideoIsNamed) {
  TimedFolder files;
  files.clips({.pictures = 8});
  for (int c = 0; c < 3; ++c) files.pictures("in/masks/cam" + std::to_string(c), 0, 8, c == 1 ? 0 : -1, 1);
  ASSERT_TRUE(files.run().ok());
  EXPECT_TRUE(files.says(files.warnings, "in/masks/cam1: lacks the matte of picture 0 of cam1.mp4")) << files.all();
  const std::vector<int> kept{1, 2, 3, 4, 5, 6, 7};
  EXPECT_EQ(files.greys(), (Greys{kept, kept, kept}));
  EXPECT_EQ(files.greys(MatteNeed::Required), (Greys{kept, kept, kept}));
}

TEST(ImportTimes, AMissingFirstMatteAndLastPictureAreNoShift) {
  TimedFolder files;
  for (int c = 0; c < 3; ++c) {
    const std::string camera = "cam" + std::to_string(c);
    files.pictures("in/" + camera, 0, 8, c == 1 ? 7 : -1);
    files.pictures("in/masks/" + camera, 0, 8, c == 1 ? 0 : -1, 1);
  }
  ASSERT_TRUE(files.run().ok());
  const std::vector<int> kept{1, 2, 3, 4, 5, 6};
  EXPECT_EQ(files.greys(), (Greys{kept, kept, kept}));
  EXPECT_EQ(files.greys(MatteNeed::Required), (Greys{kept, kept, kept}));
}

TEST(ImportTimes, MattesInAFolderBesideVideos) {
  TimedFolder files;
  files.clips({.pictures = 8});
  for (int c = 0; c < 3; ++c) files.pictures("in/masks/cam" + std::to_string(c), 1, 9, c == 1 ? 3 : -1, 1);
  ASSERT_TRUE(files.run().ok());
  EXPECT_TRUE(files.says(files.warnings, "in/masks/cam1: lacks the matte of picture 2 of cam1.mp4")) << files.all();
  const std::vector<int> kept{3, 4, 5, 6, 7}, mattes{4, 5, 6, 7, 8};
  EXPECT_EQ(files.greys(), (Greys{kept, kept, kept}));
  EXPECT_EQ(files.greys(MatteNeed::Required), (Greys{mattes, mattes, mattes}));
}

TEST(ImportTimes, StampsInNamesAreSortedAndPaired) {
  TimedFolder files;
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 6; ++i) {
      const int ms = 880 + 40 * i + 3 * c;  // clocks differ by some milliseconds
      char name[80];
      std::snprintf(name, sizeof name, "in/cam%d/%d.%03d.png", c, 1700000000 + ms / 1000, ms % 1000);
      if (c != 2 || i != 2) files.write(name, Image(16, 12, 3, uint8_t(10 * i)));
    }
  ASSERT_TRUE(files.run().ok());
  EXPECT_TRUE(files.says(files.warnings, "in/cam2: lacks the picture that", "1700000000.96")) << files.all();
  const std::vector<int> kept{3, 4, 5};
  EXPECT_EQ(files.greys(), (Greys{kept, kept, kept}));
}

TEST(ImportTimes, NumbersWithoutRelationArePairedInOrder) {
  TimedFolder files;
  files.pictures("in/cam0", 0, 5);
  files.pictures("in/cam1", 0, 5);
  for (int i = 0; i < 5; ++i)
    files.write("in/cam2/DSC0" + std::to_string(7120 + i) + ".png", Image(16, 12, 3, uint8_t(10 * i)));
  ASSERT_TRUE(files.run().ok());
  EXPECT_TRUE(files.says(files.warnings, "have too little in common")) << files.all();
  const std::vector<int> kept{0, 1, 2, 3, 4};
  EXPECT_EQ(files.greys(), (Greys{kept, kept, kept}));
}

TEST(ImportTimes, CutFilesAreSaid) {
  TimedFolder files;
  files.clips({.pictures = 3});
  for (int c = 0; c < 3; ++c)
    writePlainClip(files / ("in/cam" + std::to_string(c) + ".mp4"),
                   {.pictures = 40, .grey = [](int i) { return 5 * i; }});
  const std::string cut = files / "in/cam1.mp4";
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) * 3 / 4);
  ASSERT_TRUE(files.run().ok());
  EXPECT_TRUE(files.says(files.warnings, "in/cam1.mp4: is cut off: ", "its header announces 40")) << files.all();
  EXPECT_LT(files.greys()[0].size(), 40u);
  files.write("out/capture.json", std::string(R"({"fps": 25, "sequences": [{"name": "take", "frames": 40}]})"));
  expectError(
      mattes::openCapture(files.options.folder, platform::openVideoFile, {}, MeshNeed::Nothing, MatteNeed::None),
      ErrorId::VideoTooShort, "take/cam1.mp4: has ");
}

}  // namespace
}  // namespace fourdvt::capture

// SPDX-License-Identifier: Apache-2.0
// The key of a bake that is resumed changes with every file that the bake reads, wherever capture.json places it.
#include <gtest/gtest.h>

#include "bake/run/job.h"
#include "bake/stages/stages.h"
#include "capture_fixture.h"

using namespace fourdvt;
using fourdvt::capture::SmallCapture;

namespace {

std::string keyOf(const SmallCapture& files) {
  const auto capture = files.open();
  EXPECT_TRUE(capture.ok()) << capture.error().message;
  return capture.ok() ? bake::filesKey(capture.value(), capture.value().sequences[0]) : "";
}

void append(const std::string& file, const std::string& text) { std::ofstream(file, std::ios::app) << text; }

// Calibration, plates and meshes lie where capture.json says.
class PlacedElsewhere : public SmallCapture {
 public:
  PlacedElsewhere() {
    write("capture.json", R"({"calibration": {"ring": "rig/day2"}, "background": "empty/camNN.png", )" +
                              json(R"(, "mesh": "scans/%06d.obj")").substr(1));
    std::filesystem::create_directories(*this / "rig");
    std::filesystem::rename(*this / "cameras", *this / "rig/day2");
    std::filesystem::rename(*this / "walk/mesh", *this / "scans");
    for (const char* camera : {"cam00", "cam01"}) write("empty/" + std::string(camera) + ".png", grey(128));
  }
};

TEST(ResumeKey, CoversCalibrationPlatesAndMeshesElsewhere) {
  const PlacedElsewhere files;
  std::string key = keyOf(files);
  EXPECT_EQ(keyOf(files), key);
  for (const char* file : {"rig/day2/cameras.txt", "rig/day2/images.txt", "empty/cam01.png", "scans/000002.obj",
                           "walk/cam00/000001.png", "capture.json"}) {
    append(files / file, "\n");
    const std::string changed = keyOf(files);
    EXPECT_NE(changed, key) << file;
    key = changed;
  }
}

TEST(ResumeKey, CoversFilesBehindLinks) {
  const SmallCapture files;
  std::filesystem::rename(files / "walk/cam00", files / "pictures");
  std::filesystem::create_directory_symlink("../pictures", files / "walk/cam00");
  const std::string key = keyOf(files);
  append(files / "pictures/000001.png", "\n");
  EXPECT_NE(keyOf(files), key);
}

TEST(ResumeKey, CoversThePackedMesh) {
  const SmallCapture files;
  files.write("capture.json", SmallCapture::json(R"(, "mesh": {"topology": "quad.obj", "positions": "packed.i16",
                                                      "units_per_metre": 100})"));
  files.write("quad.obj", capture::quadObj(0));
  files.write("packed.i16", std::string(3 * 4 * 6, '\1'));
  const std::string key = keyOf(files);
  files.write("quad.obj",
              "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 4/4\nf 2/2 3/3 4/4\n");
  const std::string other = keyOf(files);
  EXPECT_NE(other, key) << "topology";
  std::filesystem::last_write_time(files / "packed.i16",
                                   std::filesystem::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_NE(keyOf(files), other) << "positions";
}

}  // namespace

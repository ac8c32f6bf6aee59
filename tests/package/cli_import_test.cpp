// SPDX-License-Identifier: Apache-2.0
// Imports calibrations of other programs into captures: output, links, refusals.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "command.h"

namespace fourdvt::test {
namespace {

namespace fs = std::filesystem;

// Pose2Sim calibration of the box's pictures: one camera of the four, Z up.
std::string tomlCalibration() {
  return "[cam00]\nname = \"cam00\"\nsize = [160.0, 160.0]\nmatrix = [[200.0, 0.0, 79.5], [0.0, 200.0, 79.5], "
         "[0.0, 0.0, 1.0]]\ndistortions = [-0.1, 0.0, 0.0, 0.0]\nrotation = [1.5707963267948966, 0.0, 0.0]\n"
         "translation = [0.0, 0.5, 4.0]\nfisheye = false\n";
}

TEST(Import, MakesTheSameCaptureOfACapture) {
  const std::string from = smallCapture("import-colmap", 3), out = scratch("import-colmap-out") + "/again";
  const Outcome done = fourdvt("import " + from + " -o " + out + " --sequences turn=turn --fps 25");
  ASSERT_EQ(done.code, 0) << done.output;
  EXPECT_NE(done.output.find("COLMAP, 4 cameras"), std::string::npos) << done.output;
  EXPECT_NE(done.output.find("sequence turn: 3 frames, 4 cameras with mattes"), std::string::npos) << done.output;
  EXPECT_NE(done.output.find("COLMAP defines no axis that is up; Y is assumed"), std::string::npos) << done.output;
  EXPECT_TRUE(fs::is_symlink(out + "/turn/cam03/000002.png"));
  EXPECT_EQ(readText(out + "/turn/cam03/000002.png"), readText(from + "/turn/cam03/000002.png"));
  EXPECT_TRUE(exists(out + "/turn/mask03/000002.png"));
  const auto json = nlohmann::json::parse(readText(out + "/capture.json"));
  EXPECT_EQ(json["fps"], 25);
  EXPECT_EQ(json["sequences"][0]["frames"], 3);
  // Other commands accept the import: poses and pictures agree.
  const Outcome surfaces = fourdvt("reconstruct " + out + " -o " + out + "-surfaces --refine none --voxel-mm 20");
  EXPECT_EQ(surfaces.code, 0) << surfaces.output;

  const Outcome again = fourdvt("import " + from + " -o " + out + " --sequences turn=turn");
  EXPECT_EQ(again.code, 1);
  EXPECT_TRUE(isOneLineWith(again, "exists already")) << again.output;
}

TEST(Import, TurnsScalesAndSaysWhatIsMissing) {
  const std::string from = smallCapture("import-toml", 2), out = scratch("import-toml-out") + "/box";
  fs::remove_all(from + "/cameras");
  writeText(from + "/Calib.toml", tomlCalibration());
  const Outcome done = fourdvt("import " + from + "/Calib.toml -o " + out + " --sequences turn=turn --scale 2");
  ASSERT_EQ(done.code, 0) << done.output;
  EXPECT_NE(done.output.find("Z becomes Y (Pose2Sim or Caliscope defines it)"), std::string::npos) << done.output;
  EXPECT_NE(done.output.find("one unit is 2 m"), std::string::npos) << done.output;
  EXPECT_NE(done.output.find("no camera of the calibration has this name"), std::string::npos) << done.output;
  const std::string cameras = readText(out + "/cameras/cameras.txt");
  EXPECT_NE(cameras.find("1 OPENCV 160 160 200.000000000 200.000000000 80.000000000 80.000000000 -0.1 0 0 0"),
            std::string::npos)
      << cameras;
  // Rotation about x by a quarter turn from Z up to the pictures' y down; from Y up by half a turn.
  const std::string images = readText(out + "/cameras/images.txt");
  EXPECT_NE(images.find(" 0.000000000000 1.000000000000 8.000000000000 1 cam00"), std::string::npos) << images;
}

TEST(Import, RefusesInOneLine) {
  const std::string from = smallCapture("import-wrong", 2), out = scratch("import-wrong-out") + "/box";
  fs::remove_all(from + "/cameras");
  const auto refused = [&](const std::string& arguments, const std::string& named) {
    const Outcome outcome = fourdvt("import " + from + " -o " + out + arguments);
    EXPECT_EQ(outcome.code, 1) << outcome.output;
    EXPECT_TRUE(isOneLineWith(outcome, named)) << outcome.output;
    EXPECT_FALSE(exists(out));
    EXPECT_FALSE(exists(out + ".part"));
  };
  refused("", "known are COLMAP (cameras.txt, cameras.bin), nerfstudio");
  writeText(from + "/Calib.toml", tomlCalibration());
  refused(" --sequences turn=elsewhere", "of any of the cameras cam00");
  std::string other = tomlCalibration();
  other.replace(other.find("160.0"), 5, "320.0");
  writeText(from + "/Calib.toml", other);
  refused(" --sequences turn=turn", "160x160 pixels, but camera cam00 is calibrated for 320x160");
}

}  // namespace
}  // namespace fourdvt::test

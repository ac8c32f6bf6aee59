// SPDX-License-Identifier: Apache-2.0
// Calibration of times and cameras from the command line: results, written files, refusals. The capture is a virtual
// studio's with known times; a camera is turned by its line in images.txt.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "command.h"
#include "platform/files.h"

namespace fourdvt::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kFrames = 14;
const std::string kStudio =
    "studio procedural --cameras 6 --size 210x280 --sequences walk --frames 14 --no-truth --test-every 4 --seed 5 "
    "--images --offset-frames 1.2 -o ";

void writeText(const std::string& path, const std::string& text) {
  ASSERT_TRUE(platform::writeFileAtomic(path, text).ok()) << path;
}

// Text of images.txt with one camera turned about its picture's vertical axis.
std::string turned(const std::string& images, const std::string& camera, double degrees) {
  std::istringstream lines(images);
  std::string out, line;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::vector<std::string> word;
    for (std::string w; words >> w;) word.push_back(w);
    if (word.size() != 10 || word[9].rfind(camera, 0) != 0) {
      out += line + "\n";
      continue;
    }
    const double h = degrees * 3.14159265358979323846 / 360, c = std::cos(h), s = std::sin(h);
    const auto at = [&](size_t i) { return std::stod(word[i]); };
    // Product of the quaternion (cos h, 0, sin h, 0) and (w, x, y, z), and the same turn of the translation.
    const double w = c * at(1) - s * at(3), x = c * at(2) + s * at(4), y = c * at(3) + s * at(1),
                 z = c * at(4) - s * at(2);
    const double c2 = std::cos(2 * h), s2 = std::sin(2 * h);
    std::ostringstream text;
    text.precision(12);
    text << word[0] << " " << w << " " << x << " " << y << " " << z << " " << c2 * at(5) + s2 * at(7) << " " << at(6)
         << " " << -s2 * at(5) + c2 * at(7) << " " << word[8] << " " << word[9] << "\n";
    out += text.str();
  }
  return out;
}

class Calibrate : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = scratch("calibrate");
    const Outcome made = lab(kStudio + given());
    ASSERT_EQ(made.code, 0) << made.output;
    const Outcome outcome = fourdvt("calibrate " + given() + " -o " + folder_ + "/found");
    ASSERT_EQ(outcome.code, 0) << outcome.output;
    output_ = outcome.output;
  }
  static std::string given() { return folder_ + "/given"; }
  static Json json(const std::string& path) { return Json::parse(readText(path)); }
  // Copies the capture with another calibration.
  static std::string withCamera(const std::string& name, const std::string& camera, double degrees) {
    const std::string to = folder_ + "/" + name;
    fs::copy(given(), to, fs::copy_options::recursive);
    writeText(to + "/cameras/images.txt", turned(readText(given() + "/cameras/images.txt"), camera, degrees));
    return to;
  }

  static inline std::string folder_, output_;
};

TEST_F(Calibrate, FindsTheStudiosTimes) {
  const Json truth = json(given() + "/capture.json")["studio"]["offset_frames_true"];
  const Json sequence = json(folder_ + "/found/capture.json")["sequences"][0];
  std::vector<double> apart;
  for (int c = 0; c < 6; ++c) {
    const double found = sequence["offset_frames"].value("cam0" + std::to_string(c), 0.0);
    apart.push_back(found + truth[c].get<double>());  // the camera lags, so that its pictures are earlier
  }
  const auto [low, high] = std::minmax_element(apart.begin(), apart.end());
  EXPECT_LT(*high - *low, 0.2);  // within a tenth of a common time
  EXPECT_NE(output_.find("cam0"), std::string::npos) << output_;
  EXPECT_NE(output_.find("is off by"), std::string::npos) << output_;
  EXPECT_NE(readText(folder_ + "/found/calibrate.html").find("is off by"), std::string::npos);
  EXPECT_TRUE(exists(folder_ + "/found/calibrate-before.jpg"));
  EXPECT_TRUE(exists(folder_ + "/found/calibrate-after.jpg"));
  // Only frames for which every camera has a picture remain.
  EXPECT_LT(sequence["frames"].get<int>(), kFrames);
  EXPECT_GE(sequence["frames"].get<int>(), kFrames - 8);
  EXPECT_TRUE(fs::is_symlink(folder_ + "/found/walk/cam00"));
}

TEST_F(Calibrate, FindsNothingMoreInWhatItWrote) {
  const Outcome again = fourdvt("calibrate " + folder_ + "/found");
  EXPECT_EQ(again.code, 0) << again.output;
  // Whole frames are corrected, half a frame remains.
  EXPECT_EQ(again.output.find("is off by 1"), std::string::npos) << again.output;
  EXPECT_EQ(again.output.find("is off by −1"), std::string::npos) << again.output;
  EXPECT_EQ(again.output.find("was turned"), std::string::npos) << again.output;
}

TEST_F(Calibrate, ReconstructDoesTheSame) {
  const std::string coarse = " --voxel-mm 20 --refine none --any-silhouettes";
  const Outcome with = fourdvt("reconstruct " + given() + " -o " + folder_ + "/hulls" + coarse);
  ASSERT_EQ(with.code, 0) << with.output;
  EXPECT_NE(with.output.find("is off by"), std::string::npos) << with.output;
  const Outcome without = fourdvt("reconstruct " + given() + " -o " + folder_ + "/late" + coarse +
                                  " --synchronise off --refine-cameras off");
  ASSERT_EQ(without.code, 0) << without.output;
  const double now = json(folder_ + "/hulls/reconstruct.json")["mean_overlap"],
               before = json(folder_ + "/late/reconstruct.json")["mean_overlap"];
  EXPECT_GT(now, before + 0.02);
  const Json sequence = json(folder_ + "/hulls/capture.json")["sequences"][0];
  EXPECT_EQ(sequence["offset_frames"], json(folder_ + "/found/capture.json")["sequences"][0]["offset_frames"]);
  // Meshes are numbered like their frames.
  const int first = sequence.value("first_frame", 0), last = first + sequence["frames"].get<int>() - 1;
  char name[32];
  std::snprintf(name, sizeof name, "/%06d.ply", last);
  EXPECT_TRUE(exists(folder_ + "/hulls/walk/mesh" + name));
  // A single mesh cannot be refined where every frame has its own: an error, not silently skipped.
  const Outcome bake = fourdvt("bake " + folder_ + "/hulls -o " + folder_ + "/character --refine outline");
  EXPECT_NE(bake.code, 0);
  EXPECT_TRUE(isOneLineWith(bake, "another topology in every frame")) << bake.output;
}

TEST_F(Calibrate, TurnsACameraBack) {
  const std::string off = withCamera("turned", "cam02", 0.6);
  const Outcome outcome = fourdvt("calibrate " + off + " -o " + folder_ + "/back");
  ASSERT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("cam02 was turned by 0."), std::string::npos) << outcome.output;
  for (const Json& camera : json(folder_ + "/back/calibrate.json")["cameras"]) {
    if (camera["name"] != "cam02") {
      EXPECT_FALSE(camera["turned"].get<bool>()) << camera;
      continue;
    }
    EXPECT_NEAR(camera["turn_deg"][1].get<double>(), -0.6, 0.1);
    EXPECT_NEAR(camera["turn_deg"][0].get<double>(), 0, 0.1);
    EXPECT_NEAR(camera["turn_deg"][2].get<double>(), 0, 0.15);
  }
}

TEST_F(Calibrate, NamesACameraThatNoPoseExplains) {
  // Camera 3 receives the pictures of camera 1.
  const std::string off = folder_ + "/swapped";
  fs::copy(given(), off, fs::copy_options::recursive);
  for (const char* what : {"cam", "mask"}) {
    fs::remove_all(off + "/walk/" + what + "03");
    fs::copy(off + "/walk/" + what + "01", off + "/walk/" + what + "03");
  }
  const Outcome outcome = fourdvt("calibrate " + off);
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("no pose and no time of camera \"cam03\" explains its silhouettes"), std::string::npos)
      << outcome.output;
  EXPECT_NE(outcome.output.find("--leave-out cam03"), std::string::npos) << outcome.output;
}

TEST_F(Calibrate, RefusesInOneLine) {
  const std::string long_offset = folder_ + "/long";
  fs::copy(given(), long_offset, fs::copy_options::recursive);
  Json capture = json(given() + "/capture.json");
  capture["sequences"][0]["offset_frames"] = {{"cam02", 40.5}};
  writeText(long_offset + "/capture.json", capture.dump());
  const Outcome too_long = fourdvt("calibrate " + long_offset);
  EXPECT_NE(too_long.code, 0);
  EXPECT_TRUE(isOneLineWith(too_long, "longer than the clip of 14 frames")) << too_long.output;
  EXPECT_NE(too_long.output.find("40.5 of camera \"cam02\""), std::string::npos) << too_long.output;
  const Outcome few = fourdvt("calibrate " + given() + " --leave-out cam00,cam01,cam02,cam03");
  EXPECT_NE(few.code, 0);
  EXPECT_TRUE(isOneLineWith(few, "fewer than three cameras")) << few.output;
  const Outcome inside = fourdvt("calibrate " + given() + " -o " + given() + "/out");
  EXPECT_TRUE(isOneLineWith(inside, "lies inside the capture")) << inside.output;
}

TEST_F(Calibrate, SaysThatMoreMayBeSearched) {
  const Outcome outcome = fourdvt("calibrate " + given() + " --most-offset 1");
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("--most-offset"), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace fourdvt::test

// SPDX-License-Identifier: Apache-2.0
// Mattes from the command line: written files, kept files, refusals, and reconstruction from them. The capture is a
// room of the virtual studio with known true mattes.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "command.h"
#include "platform/files.h"

namespace fourdvt::test {
namespace {

namespace fs = std::filesystem;

const std::string kStudio =
    "studio procedural --room --cameras 5 --size 180x240 --sequences walk --frames 4 --no-truth --test-every 4 "
    "--noise 1.5 --plates 2 --seed 5 --images --bystander -o ";

class Mattes : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    capture_ = scratch("mattes-capture") + "/room";
    const Outcome made = lab(kStudio + capture_);
    ASSERT_EQ(made.code, 0) << made.output;
    folder_ = scratch("mattes");
    const Outcome outcome = fourdvt("mattes " + capture_ + " -o " + folder_ + "/made");
    ASSERT_EQ(outcome.code, 0) << outcome.output;
  }
  // Intersection over union of a capture's mattes with the true ones, over all cameras.
  static double agreement(const std::string& capture) {
    const Outcome outcome = lab("mattes " + capture);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    const size_t all = outcome.output.find("\nall ");
    return all == std::string::npos ? 0 : std::stod(outcome.output.substr(outcome.output.find_first_of('.', all) - 1));
  }
  static std::string made() { return folder_ + "/made"; }

  static inline std::string capture_, folder_;
};

TEST_F(Mattes, MakeACaptureOfLinks) {
  for (const char* file : {"/walk/mask00/000000.png", "/walk/mask04/000003.png", "/mattes.html", "/mattes.json",
                           "/mattes-1.jpg", "/mattes-5.jpg", "/capture.json"})
    EXPECT_TRUE(exists(made() + file)) << file;
  EXPECT_TRUE(fs::is_symlink(made() + "/walk/cam00"));
  EXPECT_FALSE(exists(made() + ".part"));
  EXPECT_FALSE(exists(made() + ".work"));
  const auto json = nlohmann::json::parse(readText(made() + "/mattes.json"));
  EXPECT_EQ(json["sequences"]["walk"].size(), 4u);
  EXPECT_EQ(json["cameras"][0]["from"], "plates");
}

TEST_F(Mattes, AreBetterTogetherThanAlone) {
  const double together = agreement(made()), alone = agreement(capture_);
  EXPECT_GT(together, 0.95);
  EXPECT_GT(together, alone + 0.01);  // one camera sees another person
  // Existing mattes of a capture are kept: a second run writes the same files.
  const Outcome again = fourdvt("mattes " + made() + " -o " + folder_ + "/again --preview 1");
  EXPECT_EQ(again.code, 0) << again.output;
  EXPECT_FALSE(exists(folder_ + "/again/preview/walk/mask00/000002.png"));
  EXPECT_NE(readText(folder_ + "/again/mattes.html").find("the capture&#39;s mattes"), std::string::npos)
      << readText(folder_ + "/again/mattes.html").substr(0, 3000);
}

TEST_F(Mattes, PreviewIsAReportAlone) {
  const std::string look = folder_ + "/look";
  const Outcome outcome = fourdvt("mattes " + capture_ + " -o " + look + " --preview 2");
  ASSERT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_TRUE(exists(look + "/mattes.html"));
  EXPECT_TRUE(exists(look + "/mattes-1.jpg"));
  EXPECT_FALSE(exists(look + "/capture.json"));
  EXPECT_EQ(nlohmann::json::parse(readText(look + "/mattes.json"))["frames"], 2);
}

TEST_F(Mattes, GoOnAfterAnInterruption) {
  const std::string target = folder_ + "/resumed";
  const Outcome stopped = interrupted(FOURDVT_BIN, "mattes " + capture_ + " -o " + target,
                                      target + ".work/mattes/walk/000001.bin", folder_ + "/log");
  EXPECT_NE(stopped.code, 0);
  EXPECT_FALSE(exists(target));
  const Outcome other = fourdvt("mattes " + capture_ + " -o " + target + " --resume --mattes-alone");
  EXPECT_EQ(other.code, 1);
  EXPECT_TRUE(isOneLineWith(other, "was left by a run with other options")) << other.output;
  const Outcome resumed = fourdvt("mattes " + capture_ + " -o " + target + " --resume");
  ASSERT_EQ(resumed.code, 0) << resumed.output;
  EXPECT_GE(nlohmann::json::parse(readText(target + "/mattes.json"))["frames_of_an_earlier_run"], 1);
  for (int c = 0; c < 5; ++c) {
    const std::string mask = "/walk/mask0" + std::to_string(c);
    EXPECT_EQ(differences(target + mask, made() + mask), std::vector<std::string>{});
  }
}

TEST_F(Mattes, NeverWriteIntoTheCapture) {
  const std::string given = copyOf(capture_, "mattes-given");
  fs::create_directories(given + "/walk/mask01");  // no frame 0: no mattes
  writeText(given + "/walk/mask01/000002.png", "somebody's file");
  const Outcome outcome = fourdvt("mattes " + given + " -o " + folder_ + "/given");
  ASSERT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_EQ(readText(given + "/walk/mask01/000002.png"), "somebody's file");
  EXPECT_FALSE(exists(given + "/walk/mask01/000000.png"));
  EXPECT_TRUE(exists(folder_ + "/given/walk/mask01/000000.png"));
}

TEST_F(Mattes, NeedNoPlates) {
  const std::string bare = copyOf(capture_, "mattes-bare");
  fs::remove_all(bare + "/background");
  const Outcome key = fourdvt("bake " + bare + " -o " + folder_ + "/no");
  EXPECT_EQ(key.code, 1);
  EXPECT_TRUE(isOneLineWith(key, "fourdvt mattes")) << key.output;
  const Outcome outcome = fourdvt("mattes " + bare + " -o " + folder_ + "/bare");
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("has no plate"), std::string::npos) << outcome.output;
  EXPECT_TRUE(exists(folder_ + "/bare/walk/mask03/000003.png"));
  EXPECT_GT(agreement(folder_ + "/bare"), 0.3);  // four frames of a walk in place: only limbs move
}

TEST_F(Mattes, ObeyHints) {
  const std::string hinted = copyOf(capture_, "mattes-hinted");
  Image strokes(180, 240, 4);
  for (int y = 4; y < 24; ++y)
    for (int x = 4; x < 24; ++x) std::fill_n(strokes.at(x, y), 4, uint8_t(255));
  fs::create_directories(hinted + "/hints/cam01");
  ASSERT_TRUE(platform::writeImage(hinted + "/hints/cam01/000001.png", strokes).ok());
  const Outcome outcome = fourdvt("mattes " + hinted + " -o " + folder_ + "/hinted");
  ASSERT_EQ(outcome.code, 0) << outcome.output;
  const auto at = [&](int frame, int camera) {
    const auto matte = platform::readImage(folder_ + "/hinted/walk/mask0" + std::to_string(camera) + "/00000" +
                                           std::to_string(frame) + ".png");
    return matte.ok() ? int(matte.value().pixels[size_t(14 * 180 + 14) * size_t(matte.value().channels)]) : -1;
  };
  EXPECT_EQ(at(0, 1), 0);
  EXPECT_EQ(at(1, 1), 255);
  EXPECT_EQ(at(1, 2), 0);
  ASSERT_TRUE(platform::writeImage(hinted + "/hints/cam01/000002.png", Image(90, 240, 4)).ok());
  const Outcome wrong = fourdvt("mattes " + hinted + " -o " + folder_ + "/wrong");
  EXPECT_EQ(wrong.code, 1);
  EXPECT_TRUE(isOneLineWith(wrong, "hints/cam01/000002.png: picture of 90x240 pixels")) << wrong.output;
}

TEST_F(Mattes, NameTheCameraThatDoesNotFit) {
  const std::string mixed = copyOf(capture_, "mattes-mixed");
  // Simulates a camera turned after its calibration: its pictures and plates are shifted by 50 pixels.
  for (const char* part : {"/walk/cam02", "/background/cam02"})
    for (const auto& file : fs::directory_iterator(mixed + part)) {
      auto picture = platform::readImage(file.path().string());
      ASSERT_TRUE(picture.ok());
      Image& p = picture.value();
      for (int y = 0; y < p.height; ++y)
        std::rotate(p.at(0, y), p.at(50, y), p.at(0, y) + size_t(p.width) * size_t(p.channels));
      ASSERT_TRUE(platform::writeImage(file.path().string(), p).ok());
    }
  for (const std::string command : {"mattes ", "reconstruct --refine none "}) {
    const std::string target = folder_ + "/mixed-" + command[0];
    const Outcome outcome = fourdvt(command + mixed + " -o " + target);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.output.find("walk, frame 0: the silhouette of camera \"cam02\" does not fit"), std::string::npos)
        << outcome.output;
    EXPECT_NE(outcome.output.find("--leave-out"), std::string::npos);
    EXPECT_FALSE(exists(target));
    EXPECT_TRUE(exists(target + ".work"));
  }
  // A command does not remove unfinished work of another one.
  const Outcome taken = fourdvt("reconstruct " + mixed + " -o " + folder_ + "/mixed-m --leave-out cam02");
  EXPECT_TRUE(isOneLineWith(taken, "unfinished work of another command")) << taken.output;
  const Outcome without =
      fourdvt("reconstruct --refine none " + mixed + " -o " + folder_ + "/mixed --leave-out cam02 --voxel-mm 25");
  ASSERT_EQ(without.code, 0) << without.output;
  const std::string images = readText(folder_ + "/mixed/cameras_kept/images.txt");
  EXPECT_EQ(images.find("cam02"), std::string::npos);
  EXPECT_NE(images.find("cam04"), std::string::npos);
  EXPECT_EQ(fourdvt("reconstruct --refine none " + folder_ + "/mixed -o " + folder_ + "/again2 --voxel-mm 25").code, 0);
  const Outcome unknown = fourdvt("mattes " + mixed + " -o " + folder_ + "/u --leave-out cam9");
  EXPECT_TRUE(isOneLineWith(unknown, "no camera of")) << unknown.output;
  const Outcome few = fourdvt("mattes " + mixed + " -o " + folder_ + "/u --leave-out cam00,cam01,cam02,cam03");
  EXPECT_TRUE(isOneLineWith(few, "fewer than two cameras")) << few.output;
  const Outcome forced = fourdvt("mattes " + mixed + " -o " + folder_ + "/forced --any-silhouettes --preview 1");
  EXPECT_EQ(forced.code, 0) << forced.output;
}

TEST_F(Mattes, AreMadeByReconstructWhereTheyAreMissing) {
  const std::string surfaces = folder_ + "/surfaces";
  const Outcome outcome = fourdvt("reconstruct " + capture_ + " -o " + surfaces + " --refine none --voxel-mm 20");
  ASSERT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_TRUE(exists(surfaces + "/walk/mask02/000003.png"));
  EXPECT_TRUE(exists(surfaces + "/mattes.html"));
  EXPECT_TRUE(exists(surfaces + "/walk/mesh/000003.ply"));
  EXPECT_EQ(differences(surfaces + "/walk/mask02", made() + "/walk/mask02"), std::vector<std::string>{});
  const auto json = nlohmann::json::parse(readText(surfaces + "/reconstruct.json"));
  EXPECT_GT(json["mean_overlap"], 0.93);
  const Outcome over = fourdvt("mattes " + capture_ + " -o " + surfaces);
  EXPECT_EQ(over.code, 1);
  EXPECT_TRUE(isOneLineWith(over, "another command's result")) << over.output;
  EXPECT_TRUE(exists(surfaces + "/walk/mesh/000003.ply"));
}

}  // namespace
}  // namespace fourdvt::test

// SPDX-License-Identifier: Apache-2.0
// The virtual studio from the command line: a procedural capture and one of a GLB, both baked; invalid command lines
// and models.
#include <gtest/gtest.h>

#include "../unit/studio_model.h"
#include "command.h"

namespace fourdvt::test {
namespace {

const std::string kTiny = " --cameras 4 --size 96x128 --fps 5 --test-every 3 --truth-phases 1 --truth-ring 0";
const std::string kBake = " --texture 128 --layers 2 --gop 4 --jobs 2 --align none --renditions highest";

TEST(Studio, ProceduralCaptureBakes) {
  const std::string out = scratch("studio");
  const Outcome studio = lab("studio --actor procedural -o " + out + "/capture --mesh-cell-mm 45 --drift-mm 12" +
                             kTiny + " --truth 0,0.5,1");
  ASSERT_EQ(studio.code, 0) << studio.output;
  EXPECT_FALSE(exists(out + "/capture.work"));
  for (const char* file : {"/capture.json", "/cameras_test/images.txt", "/walk/mask03.mkv", "/run/test02/0003.png",
                           "/truth/locomotion/truth.json", "/truth/locomotion/w050/test01/0000.png"})
    EXPECT_TRUE(exists(out + "/capture" + file)) << file;
  EXPECT_NE(readText(out + "/capture/capture.json").find("\"drift_mm\": 12.0"), std::string::npos);
  const Outcome bake = fourdvt("bake " + out + "/capture -o " + out + "/character" + kBake);
  ASSERT_EQ(bake.code, 0) << bake.output;
  const Outcome inspect = fourdvt("inspect " + out + "/character");
  EXPECT_EQ(inspect.code, 0) << inspect.output;
  const Outcome score = lab("score " + out + "/character --capture " + out +
                            "/capture --input-every 0 --flicker 0 -o " + out + "/figures");
  EXPECT_EQ(score.code, 0) << score.output;
}

// Refinement from the command line: turned cameras are written back as a COLMAP text model; a second refinement finds
// no further turn.
TEST(Studio, TurnedCamerasAreWrittenRefined) {
  const std::string out = scratch("studio-turned");
  const std::string size = " --size 240x320 --sequences walk --fps 6 --no-truth --mesh-cell-mm 45";
  const std::string bake = " --texture 128 --layers 2 --no-classes --renditions highest";
  ASSERT_EQ(lab("studio procedural -o " + out + "/capture --rotation-deg 0.4" + size).code, 0);
  const Outcome refined = fourdvt("bake " + out + "/capture -o " + out + "/refined" + bake);
  ASSERT_EQ(refined.code, 0) << refined.output;
  for (const char* file : {"/cameras_refined/cameras.txt", "/cameras_refined/images.txt"})
    EXPECT_TRUE(exists(out + "/refined.report" + file)) << file;
  EXPECT_NE(readText(out + "/refined.report/report.html").find("cameras_refined"), std::string::npos);
  EXPECT_NE(readText(out + "/refined.report/report.json").find("\"changed\": true"), std::string::npos);

  const Outcome as_given =
      fourdvt("bake " + out + "/capture -o " + out + "/given --refine none --refine-cameras off" + bake);
  ASSERT_EQ(as_given.code, 0) << as_given.output;
  EXPECT_FALSE(exists(out + "/given.report/cameras_refined"));
  EXPECT_EQ(readText(out + "/given.report/report.json").find("\"refinement\""), std::string::npos);

  for (const char* file : {"cameras.txt", "images.txt"})
    std::filesystem::copy_file(out + "/refined.report/cameras_refined/" + file, out + "/capture/cameras/" + file,
                               std::filesystem::copy_options::overwrite_existing);
  const Outcome again = fourdvt("bake " + out + "/capture -o " + out + "/again" + bake);
  ASSERT_EQ(again.code, 0) << again.output;
  EXPECT_FALSE(exists(out + "/again.report/cameras_refined"));
  EXPECT_EQ(readText(out + "/again.report/report.json").find("\"changed\": true"), std::string::npos);
}

TEST(Studio, ModelIsCapturedByItsAnimationsNames) {
  const std::string out = scratch("studio-model");
  const std::string model = fourdvt::testing::StudioModel().write(out + "/tube.glb");
  const Outcome studio = lab("studio " + model + " -o " + out + "/capture --sequences still,bend,fall" + kTiny +
                             " --class bow=angle:still,bend");
  ASSERT_EQ(studio.code, 0) << studio.output;
  const std::string json = readText(out + "/capture/capture.json");
  EXPECT_NE(json.find("\"parameter\": \"angle\""), std::string::npos);
  EXPECT_TRUE(exists(out + "/capture/truth/bow/w040/test00/0000.png"));
  const Outcome bake = fourdvt("bake " + out + "/capture -o " + out + "/character --no-classes" + kBake);
  EXPECT_EQ(bake.code, 0) << bake.output;
}

// Without mattes, the bake keys against the plates.
TEST(Studio, RoomBakesFromItsPlates) {
  const std::string out = scratch("studio-room");
  const std::string studio = "studio procedural --room --sequences walk --no-truth --mesh-cell-mm 45 -o " + out;
  const Outcome made = lab(studio + "/capture --plates 3 --noise 5.1 --cameras 4 --size 192x256 --fps 4");
  ASSERT_EQ(made.code, 0) << made.output;
  EXPECT_TRUE(exists(out + "/capture/background/cam03/000002.png"));
  EXPECT_TRUE(exists(out + "/capture/mattes_true/walk/mask03.mkv"));
  EXPECT_FALSE(exists(out + "/capture/walk/mask03.mkv"));
  const Outcome bake = fourdvt("bake " + out + "/capture -o " + out + "/character" + kBake);
  EXPECT_EQ(bake.code, 0) << bake.output;
  const Outcome mattes = lab("mattes " + out + "/capture -o " + out + "/mattes.json");
  EXPECT_EQ(mattes.code, 0) << mattes.output;
  EXPECT_NE(mattes.output.find("walk         cam03           4"), std::string::npos) << mattes.output;
  EXPECT_NE(readText(out + "/mattes.json").find("\"iou_outside_band\": 0."), std::string::npos);
  const Outcome no_truth = lab("mattes " + out + "/capture --against background");
  EXPECT_EQ(no_truth.code, 1);
  EXPECT_NE(no_truth.output.find("background/walk/mask00.mkv"), std::string::npos) << no_truth.output;
  EXPECT_EQ(lab(studio + "/c --erosion 2").code, 2);
  EXPECT_EQ(lab("studio procedural --plates 2 -o " + out + "/c").code, 2);
}

TEST(Studio, WrongCommandsAndModelsAreOneLine) {
  const std::string out = scratch("studio-wrong");
  EXPECT_EQ(lab("studio procedural").code, 2);
  EXPECT_EQ(lab("studio procedural -o " + out + "/c --class locomotion").code, 2);
  EXPECT_EQ(lab("studio procedural -o " + out + "/c --size 97x128").code, 2);
  EXPECT_EQ(lab("studio procedural -o " + out + "/c --truth 0,2").code, 2);
  const Outcome unknown = lab("studio procedural -o " + out + "/c --sequences walk,fly");
  EXPECT_EQ(unknown.code, 1);
  EXPECT_TRUE(isOneLineWith(unknown, "choose among walk, jog, run, stand and raise")) << unknown.output;
  const Outcome blended = lab("studio procedural -o " + out + "/c --sequences walk,stand --class c=p:walk,stand");
  EXPECT_EQ(blended.code, 1);
  EXPECT_TRUE(isOneLineWith(blended, "\"stand\" does not blend")) << blended.output;
  const Outcome missing = lab("studio " + out + "/none.glb -o " + out + "/c");
  EXPECT_EQ(missing.code, 1);
  EXPECT_TRUE(isOneLineWith(missing, out + "/none.glb")) << missing.output;
  writeText(out + "/mine.txt", "somebody's work");
  const Outcome taken = lab("studio procedural -o " + out + "/mine.txt" + kTiny);
  EXPECT_EQ(taken.code, 1);
  EXPECT_TRUE(isOneLineWith(taken, "not a studio capture")) << taken.output;
  EXPECT_EQ(readText(out + "/mine.txt"), "somebody's work");
  EXPECT_FALSE(exists(out + "/c"));
  EXPECT_FALSE(exists(out + "/c.work"));
}

}  // namespace
}  // namespace fourdvt::test

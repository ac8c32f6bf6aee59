// SPDX-License-Identifier: Apache-2.0
// The virtual studio as a user runs it: a procedural capture and one of a GLB, both of which bake; wrong command lines
// and models.
#include <gtest/gtest.h>

#include "../unit/studio_model.h"
#include "command.h"

namespace fourdvt::test {
namespace {

const std::string kTiny = " --cameras 4 --size 96x128 --fps 5 --test-every 3 --truth-phases 1 --truth-ring 0";
const std::string kBake = " --texture 128 --layers 2 --gop 4 --jobs 2 --align none";

TEST(Studio, ProceduralCaptureBakes) {
  const std::string out = scratch("studio");
  const Outcome studio = fourdvt("studio --actor procedural -o " + out + "/capture --mesh-cell-mm 45 --drift-mm 12" +
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
  const Outcome evaluate =
      fourdvt("evaluate " + out + "/capture --character " + out + "/character --input-every 0 -o " + out + "/figures");
  EXPECT_EQ(evaluate.code, 0) << evaluate.output;
}

TEST(Studio, ModelIsCapturedByItsAnimationsNames) {
  const std::string out = scratch("studio-model");
  const std::string model = fourdvt::testing::StudioModel().write(out + "/tube.glb");
  const Outcome studio = fourdvt("studio " + model + " -o " + out + "/capture --sequences still,bend,fall" + kTiny +
                                 " --class bow=angle:still,bend");
  ASSERT_EQ(studio.code, 0) << studio.output;
  const std::string json = readText(out + "/capture/capture.json");
  EXPECT_NE(json.find("\"parameter\": \"angle\""), std::string::npos);
  EXPECT_TRUE(exists(out + "/capture/truth/bow/w040/test00/0000.png"));
  const Outcome bake = fourdvt("bake " + out + "/capture -o " + out + "/character --no-classes" + kBake);
  EXPECT_EQ(bake.code, 0) << bake.output;
}

TEST(Studio, WrongCommandsAndModelsAreOneLine) {
  const std::string out = scratch("studio-wrong");
  EXPECT_EQ(fourdvt("studio procedural").code, 2);
  EXPECT_EQ(fourdvt("studio procedural -o " + out + "/c --class locomotion").code, 2);
  EXPECT_EQ(fourdvt("studio procedural -o " + out + "/c --size 97x128").code, 2);
  EXPECT_EQ(fourdvt("studio procedural -o " + out + "/c --truth 0,2").code, 2);
  const Outcome unknown = fourdvt("studio procedural -o " + out + "/c --sequences walk,fly");
  EXPECT_EQ(unknown.code, 1);
  EXPECT_TRUE(isOneLineWith(unknown, "choose among walk, jog and run")) << unknown.output;
  const Outcome missing = fourdvt("studio " + out + "/none.glb -o " + out + "/c");
  EXPECT_EQ(missing.code, 1);
  EXPECT_TRUE(isOneLineWith(missing, out + "/none.glb")) << missing.output;
  writeText(out + "/mine.txt", "somebody's work");
  const Outcome taken = fourdvt("studio procedural -o " + out + "/mine.txt" + kTiny);
  EXPECT_EQ(taken.code, 1);
  EXPECT_TRUE(isOneLineWith(taken, "not a studio capture")) << taken.output;
  EXPECT_EQ(readText(out + "/mine.txt"), "somebody's work");
  EXPECT_FALSE(exists(out + "/c"));
  EXPECT_FALSE(exists(out + "/c.work"));
}

}  // namespace
}  // namespace fourdvt::test

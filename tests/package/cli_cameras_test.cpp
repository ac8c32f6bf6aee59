// SPDX-License-Identifier: Apache-2.0
// Characters from cameras: meshes that differ in every frame, an interrupted bake, invalid input.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "command.h"
#include "platform/files.h"

namespace fourdvt::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kSmall = " --gop 4 --jobs 2 --renditions highest";

// Declares the box's meshes to have a topology per frame, although they are equal.
std::string perFrame(const std::string& name, int frames = 6) {
  const std::string capture = smallCapture(name, frames);
  EXPECT_EQ(shell("sed -i '0,/{/s//{\"topology\": \"per-frame\", /' " + capture + "/capture.json").code, 0);
  return capture;
}

json reportOf(const std::string& character) { return json::parse(readText(character + ".report/report.json")); }

TEST(CameraBake, KeepsTheCamerasThatAreNamed) {
  const std::string capture = perFrame("named-cameras", 2), out = scratch("named");
  const Outcome bake = fourdvt("bake " + capture + " -o " + out + "/box --cameras cam02,cam00" + kSmall);
  ASSERT_EQ(bake.code, 0) << bake.output;
  EXPECT_NE(bake.output.find("2 of the capture's 4 cameras: cam00 cam02."), std::string::npos) << bake.output;
  const Outcome inspect = fourdvt("inspect " + out + "/box");
  EXPECT_NE(inspect.output.find("from the pictures of 2 cameras"), std::string::npos) << inspect.output;
  const Outcome none = fourdvt("bake " + capture + " -o " + out + "/none --cameras cam00,left");
  EXPECT_EQ(none.code, 1);
  EXPECT_NE(none.output.find("there is no camera \"left\"; the capture has cam00, cam01, cam02, cam03"),
            std::string::npos)
      << none.output;
  EXPECT_FALSE(exists(out + "/none"));
}

TEST(CameraBake, IsChosenForMeshesOfPerFrameTopologyAndSaysSo) {
  const std::string capture = perFrame("scanned-capture"), out = scratch("scanned");
  // One frame loses a face.
  ASSERT_EQ(shell("sed -i '$d' " + capture + "/turn/mesh/000002.obj").code, 0);
  const Outcome bake = fourdvt("bake " + capture + " -o " + out + "/box" + kSmall);
  ASSERT_EQ(bake.code, 0) << bake.output;
  EXPECT_NE(bake.output.find("The character is textured from cameras: the meshes of " + capture), std::string::npos)
      << bake.output;
  EXPECT_FALSE(exists(out + "/box.work"));
  const Outcome inspect = fourdvt("inspect " + out + "/box");
  EXPECT_EQ(inspect.code, 0) << inspect.output;
  EXPECT_NE(inspect.output.find("from the pictures of 4 cameras"), std::string::npos) << inspect.output;
  EXPECT_NE(inspect.output.find("everything decodes"), std::string::npos) << inspect.output;

  const Outcome score = lab("score " + out + "/box --capture " + capture + " --yardstick");
  ASSERT_EQ(score.code, 0) << score.output;
  for (const char* said : {"Held-out cameras", "Input cameras", "yardst. dB", "flicker is not measured"})
    EXPECT_NE(score.output.find(said), std::string::npos) << score.output;
  EXPECT_EQ(score.output.find("nan"), std::string::npos) << score.output;

  const json report = reportOf(out + "/box");
  EXPECT_EQ(report["options"]["appearance"], "cameras");
  EXPECT_EQ(report["options"]["refine"], "none");
  EXPECT_EQ(report["notes"].size(), 2u) << "the appearance, and the method: its four cameras stand too far apart";
  const json& turn = report["sequences"][0];
  EXPECT_EQ(turn["tiles"]["runs"], 3) << "two frames, the odd one, and the second GOP";
  EXPECT_GT(turn["geometry_bytes"], 100);
  EXPECT_GT(turn["tiles"]["kept_share"], 0.05);
  EXPECT_LT(turn["tiles"]["kept_share"], 0.9);
  EXPECT_TRUE(exists(out + "/box.report/report_turn.jpg"));
  auto poster = platform::readImage(out + "/box/poster.webp");
  ASSERT_TRUE(poster.ok());
  int covered = 0;
  for (size_t i = 3; i < poster.value().pixels.size(); i += 4) covered += poster.value().pixels[i] > 128;
  EXPECT_GT(covered, 10000);
  const json gltf = json::parse(readText(out + "/box/character.gltf"));
  EXPECT_EQ(gltf["extensions"]["FOURDVT_layered_video_texture"]["version"], 2);
  EXPECT_FALSE(gltf.contains("images"));
}

TEST(CameraBake, CanBeAskedForWhereLayersWouldDo) {
  const std::string capture = smallCapture("tracked-capture"), out = scratch("tracked");
  const Outcome bake =
      fourdvt("bake " + capture + " -o " + out + "/box --appearance cameras --tile-scale 0.5" + kSmall);
  ASSERT_EQ(bake.code, 0) << bake.output;
  EXPECT_EQ(bake.output.find("The character is textured"), std::string::npos) << "it was asked for";
  const json report = reportOf(out + "/box");
  EXPECT_EQ(report["options"]["refine"], "outline");
  EXPECT_EQ(report["sequences"][0]["tiles"]["runs"], report["sequences"][0]["gops"]);
  const Outcome inspect = fourdvt("inspect " + out + "/box");
  EXPECT_EQ(inspect.code, 0) << inspect.output;
}

TEST(CameraBake, IsDrawnAsAskedFor) {
  const std::string capture = perFrame("drawn-capture", 2), out = scratch("drawn");
  ASSERT_EQ(fourdvt("bake " + capture + " -o " + out + "/box" + kSmall).code, 0);
  const auto still = [&](const std::string& options) {
    const std::string file = out + "/still.png";
    const Outcome drawn = fourdvt("render " + out + "/box -o " + file + " --size 160x200 --azimuth 40 " + options);
    EXPECT_EQ(drawn.code, 0) << drawn.output;
    return readText(file);
  };
  const std::string textured = still("");
  const std::string chosen = reportOf(out + "/box")["method"]["name"];
  EXPECT_EQ(still("--method " + chosen + " --closest 4 --visibility offset"), textured) << "the defaults";
  EXPECT_NE(still("--method sweep"), still("--method fvvr"));
  EXPECT_NE(still("--closest 1"), textured);
  EXPECT_NE(still("--method silhouette"), textured);
  EXPECT_NE(still("--method wireframe"), still("--method silhouette"));
  const Outcome layered = fourdvt("render " + out + "/box -o " + out + "/no.png --method layered");
  EXPECT_NE(layered.code, 0);
  EXPECT_NE(layered.output.find("is a character from cameras"), std::string::npos) << layered.output;
}

json methodIn(const std::string& character) {
  return json::parse(readText(character + "/character.gltf"))["extensions"]["FOURDVT_layered_video_texture"]["method"];
}

constexpr const char* kNotMeasured = "The method was not measured: ";

TEST(CameraBake, FewCamerasGetASafeMethodAndSaySo) {
  const std::string capture = perFrame("few-cameras", 2), out = scratch("few");
  for (const auto& [cameras, said] : {std::pair("cam02,cam00", "leaving one of 2 cameras out leaves none to blend"),
                                      std::pair("cam01", "leaving one of 1 camera out leaves none to blend"),
                                      std::pair("cam00,cam01,cam02,cam03", "in no frame do cameras on both sides")}) {
    const Outcome bake = fourdvt("bake " + capture + " -o " + out + "/box --cameras " + cameras + kSmall);
    ASSERT_EQ(bake.code, 0) << bake.output;
    EXPECT_NE(bake.output.find(std::string(kNotMeasured) + said), std::string::npos) << bake.output;
    EXPECT_EQ(methodIn(out + "/box")["name"], "fvvr");
    const json report = reportOf(out + "/box");
    EXPECT_EQ(report["method"]["measured"], false);
    EXPECT_NE(report["notes"].dump().find(said), std::string::npos);
    EXPECT_NE(readText(out + "/box.report/report.html").find(said), std::string::npos);
  }
}

TEST(CameraBake, TheMethodIsTheOneThatIsNamed) {
  const std::string capture = perFrame("named-method", 2), out = scratch("named-method-out");
  const Outcome bake = fourdvt("bake " + capture + " -o " + out + "/box --method linear" + kSmall);
  ASSERT_EQ(bake.code, 0) << bake.output;
  EXPECT_EQ(bake.output.find(kNotMeasured), std::string::npos) << bake.output;
  EXPECT_EQ(methodIn(out + "/box")["name"], "linear");
  EXPECT_EQ(reportOf(out + "/box")["options"]["method"], "linear");
  for (const char* wrong : {"--method nearest", "--method wireframe", "--method-cost 0.5", "--method-cost much"}) {
    const Outcome refused = fourdvt("bake " + capture + " -o " + out + "/no " + wrong);
    EXPECT_EQ(refused.code, 2) << refused.output;
    EXPECT_FALSE(exists(out + "/no"));
  }
  // Manifests with an unknown method, as of a later version, and without one.
  const auto still = [&](const std::string& options = "") {
    const Outcome drawn =
        fourdvt("render " + out + "/box -o " + out + "/still.png --size 160x200 --azimuth 40" + options);
    EXPECT_EQ(drawn.code, 0) << drawn.output;
    return std::pair(readText(out + "/still.png"), drawn.output);
  };
  const auto [by_sweep, quiet] = still(" --method sweep");
  const std::string gltf = readText(out + "/box/character.gltf");
  json changed = json::parse(gltf);
  json& extension = changed["extensions"]["FOURDVT_layered_video_texture"];
  extension["method"]["name"] = "of-tomorrow";
  writeText(out + "/box/character.gltf", changed.dump());
  const auto [picture, said] = still();
  EXPECT_EQ(picture, by_sweep);
  EXPECT_NE(said.find("does not know the method of-tomorrow: sweep is drawn in place of it"), std::string::npos)
      << said;
  extension.erase("method");
  writeText(out + "/box/character.gltf", changed.dump());
  EXPECT_EQ(still(), std::pair(by_sweep, quiet));
}

// Scales the capture to 1/20, as for a figurine.
TEST(CameraBake, LengthsFollowTheSurfacesSize) {
  const std::string capture = perFrame("figurine-capture", 2), out = scratch("figurine");
  const auto stepOf = [&](const std::string& name, const std::string& options) {
    const Outcome bake = fourdvt("bake " + capture + " -o " + out + "/" + name + kSmall + options);
    EXPECT_EQ(bake.code, 0) << bake.output;
    return reportOf(out + "/" + name)["options"]["position_step_m"].get<double>();
  };
  const auto extension = [&](const std::string& name) {
    return json::parse(readText(out + "/" + name + "/character.gltf"))["extensions"]["FOURDVT_layered_video_texture"];
  };
  EXPECT_EQ(stepOf("box", ""), 0.0005) << "1.2 m, nearer to a metre than to a person";
  EXPECT_EQ(extension("box")["lengthScale"], 0.5);
  EXPECT_EQ(stepOf("given", " --position-step 0.7"), 0.0007);
  for (const char* file : {"/turn/mesh/000000.obj", "/turn/mesh/000001.obj"})
    ASSERT_EQ(shell("awk '/^v /{print $1, $2/20, $3/20, $4/20; next} {print}' " + capture + file + " > " + out +
                    "/mesh && mv " + out + "/mesh " + capture + file)
                  .code,
              0);
  ASSERT_EQ(
      shell("awk 'NF == 10 && !/^#/{$6 /= 20; $7 /= 20; $8 /= 20} {print}' " + capture + "/cameras/images.txt > " +
            out + "/images && mv " + out + "/images " + capture + "/cameras/images.txt")
          .code,
      0);
  EXPECT_EQ(stepOf("figurine", ""), 0.001 / 32);
  EXPECT_EQ(extension("figurine")["lengthScale"], 1 / 32.0);
}

TEST(CameraBake, InterruptedResumesToTheSameBytes) {
  const std::string capture = perFrame("long-scan", 32), out = scratch("camera-resume");
  const std::string options = " --gop 4 --jobs 2 --renditions 1:40,0.5:30 --sequences turn";
  ASSERT_EQ(fourdvt("bake " + capture + " -o " + out + "/straight" + options).code, 0);
  const std::string stopped = out + "/stopped";
  const Outcome stop = interrupted(FOURDVT_BIN, "bake " + capture + " -o " + stopped + options,
                                   stopped + ".work/turn.0.gop", out + "/log");
  ASSERT_EQ(stop.code, 130) << stop.output;
  EXPECT_FALSE(exists(stopped));
  const Outcome resumed = fourdvt("bake " + capture + " -o " + stopped + options + " --resume");
  ASSERT_EQ(resumed.code, 0) << resumed.output;
  EXPECT_NE(readText(stopped + ".report/report.json").find("\"resumed\": true"), std::string::npos);
  EXPECT_EQ(differences(out + "/straight", stopped), std::vector<std::string>{});
  // One job and two give the same bytes.
  ASSERT_EQ(
      fourdvt("bake " + capture + " -o " + out + "/alone --gop 4 --jobs 1 --renditions 1:40,0.5:30 --sequences turn")
          .code,
      0);
  EXPECT_EQ(differences(out + "/straight", out + "/alone"), std::vector<std::string>{});
  // Every frame of every rendition has its barcode; the smaller rendition has the same content.
  const Outcome inspect = fourdvt("inspect " + stopped);
  EXPECT_EQ(inspect.code, 0) << inspect.output;
  const auto still = [&](const std::string& choice) {
    const std::string file = out + "/still" + choice + ".png";
    const Outcome drawn =
        fourdvt("render " + stopped + " -o " + file + " --size 160x200 --azimuth 40 --no-shadow --rendition " + choice);
    EXPECT_EQ(drawn.code, 0) << drawn.output;
    auto picture = platform::readImage(file);
    EXPECT_TRUE(picture.ok());
    return picture.ok() ? picture.take() : Image();
  };
  const Image low = still("0"), high = still("2");
  ASSERT_EQ(low.pixels.size(), high.pixels.size());
  double difference = 0, covered = 0;
  for (size_t i = 0; i < low.pixels.size(); i += 4) {
    if (high.pixels[i + 3] < 255) continue;
    difference += std::abs(int(low.pixels[i]) - int(high.pixels[i]));
    ++covered;
  }
  EXPECT_GT(covered, 1000);
  EXPECT_GT(difference, 0);
  EXPECT_LT(difference / covered, 8);
}

struct WrongCameraBake : ::testing::Test {
  void SetUp() override {
    capture = perFrame("wrong-scan", 3);
    character = scratch("wrong-scan-out") + "/box";
  }
  void expectRefused(const std::string& options, const std::string& named) {
    const Outcome bake = fourdvt("bake " + capture + " -o " + character + kSmall + options);
    EXPECT_EQ(bake.code, 1) << bake.output;
    EXPECT_NE(bake.output.find(named, bake.output.find("fourdvt: ")), std::string::npos) << bake.output;
    EXPECT_FALSE(exists(character));
    EXPECT_FALSE(exists(character + ".work"));
  }
  std::string capture, character;
};

TEST_F(WrongCameraBake, PicturesThatDoNotFitSayWhichScaleDoes) {
  expectRefused(" --tile-texels 0.02", "use --tile-scale 0.");
}

// Invalid later surfaces and refinement pictures are not read before this error.
TEST_F(WrongCameraBake, PicturesThatDoNotFitAreRefusedBeforeTheRestIsRead) {
  writeText(capture + "/turn/mesh/000001.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n");
  expectRefused(" --tile-texels 0.02", "sequence 'turn', frame 0 alone: the cameras' pictures of the performer need");
  capture = smallCapture("wrong-tracked");
  for (const char* frame : {"000002", "000005"}) writeText(capture + "/turn/cam00/" + frame + ".png", "no picture");
  expectRefused(" --appearance cameras --tile-texels 0.02", "frame 0 alone: the cameras' pictures of the performer");
  expectRefused(" --appearance cameras", ".png");
  const std::string grows = capture + "/turn/mesh/000003.obj";
  ASSERT_EQ(shell("awk '/^v /{print $1, $2 * 3, $3, $4 * 3; next} {print}' " + grows + " > " + grows + ".new && mv " +
                  grows + ".new " + grows)
                .code,
            0);
  expectRefused(" --appearance cameras --tile-texels 0.0905", "sequence 'turn': the cameras' pictures of the");
}

TEST_F(WrongCameraBake, RenditionsInTexelsNeedLayers) {
  const Outcome bake = fourdvt("bake " + capture + " -o " + character + " --renditions 384:34");
  EXPECT_EQ(bake.code, 1) << bake.output;
  EXPECT_NE(bake.output.find("rendition 384:34:h264: its size must be a share"), std::string::npos) << bake.output;
  EXPECT_FALSE(exists(character));
}

TEST_F(WrongCameraBake, ClassesNeedLayers) {
  json j = json::parse(readText(capture + "/capture.json"));
  j["sequences"].push_back(j["sequences"][0]);
  j["sequences"].back()["name"] = "again";
  fs::copy(capture + "/turn", capture + "/again", fs::copy_options::recursive);
  const auto member = [](const char* name, double value) { return json{{"sequence", name}, {"value", value}}; };
  j["classes"] = json::array({{{"name", "both"},
                               {"parameter", "speed_mps"},
                               {"members", json::array({member("turn", 1), member("again", 2)})}}});
  writeText(capture + "/capture.json", j.dump());
  expectRefused("", "class 'both': classes need layers; leave them out with --no-classes");
  const Outcome without = fourdvt("bake " + capture + " -o " + character + kSmall + " --no-classes");
  EXPECT_EQ(without.code, 0) << without.output;
}

TEST_F(WrongCameraBake, AMeshThatIsBrokenIsNamed) {
  truncateTo(capture + "/turn/mesh/000001.obj", 0.1);
  writeText(capture + "/turn/mesh/000001.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n");
  expectRefused("", "turn/mesh/000001.obj");
}

TEST_F(WrongCameraBake, CamerasThatSeeNothingNameAxesAndUnits) {
  ASSERT_EQ(shell("sed -i -E 's/^v ([^ ]+) ([^ ]+) ([^ ]+)$/v \\1 \\2e6 \\3/' " + capture + "/turn/mesh/*.obj").code,
            0);
  expectRefused("", "units");
}

}  // namespace
}  // namespace fourdvt::test

// SPDX-License-Identifier: Apache-2.0
// Classes, loops and meshes that `fourdvt import` writes beside cameras and pictures.
#include <algorithm>

#include "capture/import/import_capture.h"
#include "import_fixture.h"
#include "mattes/frame_reader.h"

namespace fourdvt::capture {
namespace {

TEST(ClassOption, OneParameter) {
  const auto parsed = parseClassOption("locomotion:speed_mps=walk:1.2,run:2.7");
  ASSERT_TRUE(parsed.ok()) << parsed.error().message;
  const CaptureClass& c = parsed.value();
  EXPECT_EQ(c.name, "locomotion");
  EXPECT_EQ(c.parameters, std::vector<std::string>{"speed_mps"});
  ASSERT_EQ(c.members.size(), 2u);
  EXPECT_EQ(c.members[0].sequence, "walk");
  EXPECT_EQ(c.members[0].parameter, std::vector<double>{1.2});
  EXPECT_EQ(c.members[1].parameter, std::vector<double>{2.7});
}

TEST(ClassOption, TwoParametersHaveTwoValues) {
  const auto parsed = parseClassOption("gait:speed_mps,slope_deg=walk:1.2/0,run:2.7/0,uphill:1.1/-8");
  ASSERT_TRUE(parsed.ok()) << parsed.error().message;
  EXPECT_EQ(parsed.value().parameters, (std::vector<std::string>{"speed_mps", "slope_deg"}));
  EXPECT_EQ(parsed.value().members[2].parameter, (std::vector<double>{1.1, -8}));
}

TEST(ClassOption, SpeedsMayBeLeftToTheBake) {
  const auto parsed = parseClassOption("locomotion:speed_mps=walk,run");
  ASSERT_TRUE(parsed.ok()) << parsed.error().message;
  EXPECT_TRUE(parsed.value().members[1].parameter.empty());
}

TEST(ClassOption, RefusesInOneLine) {
  const auto refused = [](const std::string& text, const std::string& named) {
    expectError(parseClassOption(text), ErrorId::InvalidArgument, named);
  };
  for (const char* text : {"locomotion", "locomotion=walk,run", "speed_mps:=walk,run", ":speed_mps=walk,run", "a=b:c"})
    refused(text, "NAME:PARAMETER=");
  refused("l:speed_mps=walk:1.2,run", "\"run\" has 0 values of 1");
  refused("l:height_m=low,high", "\"low\" has 0 values of 1");
  refused("l:a,b=walk:1/0,run:2", "\"run\" has 1 values of 2");
  refused("l:a=walk:1/0,run:2", "\"walk\" has 2 values of 1");
  refused("l:a=walk:1,2,run:2,7", "\"2\" is no sequence; write decimals with a point");
  refused("l:a=walk:fast,run:2", "\"fast\" of \"walk\" is no number");
  refused("l:a=walk:nan,run:2", "\"nan\" of \"walk\" is no number");
  refused("l:a=walk:,run:2", "is no number");
  refused("l:a=walk:1,,run:2", "a name of a sequence is missing");
  refused("l:a=walk:1", "joins 2 to 4 sequences, not 1");
  refused("l:a=walk:1,run:2,jog:3,hop:4,fly:5", "joins 2 to 4 sequences, not 5");
}

TEST(ClassOption, MembersAreSequencesOfOneKind) {
  const std::vector<std::string> sequences{"walk", "run", "pickup"};
  const auto problem = [&](const std::string& text, const std::vector<std::string>& loops) {
    return classProblem({parseClassOption(text).value()}, sequences, loops);
  };
  EXPECT_EQ(problem("l:speed_mps=walk,run", {"walk", "run"}), "");
  EXPECT_NE(problem("l:speed_mps=walk,fly", {})
                .find("--class: class \"l\" has a member \"fly\" that is no sequence; "
                      "choose among: walk, run, pickup"),
            std::string::npos);
  EXPECT_NE(problem("l:speed_mps=walk,run", {"walk"}).find("mixes a loop"), std::string::npos);
  EXPECT_NE(problem("walk:speed_mps=walk,run", {}).find("name of a sequence"), std::string::npos);
  EXPECT_NE(problem("l:a,a=walk:1/2,run:2/3", {}).find("two different ones"), std::string::npos);
}

// Two takes of one camera, each with meshes whose numbers begin elsewhere.
class ImportWithMeshes : public TempFolder {
 public:
  ImportWithMeshes() {
    write("in/cam1.yml", std::string("K: [20, 0, 7.5, 0, 20, 5.5, 0, 0, 1]\nR: [0, 0, 0.1]\nT: [0, 0, 3]\n"));
    for (const char* take : {"walk", "run"}) {
      for (int frame = 0; frame < 3; ++frame) {
        const std::string folder = std::string("in/") + take;
        write(folder + "/cam1/" + std::to_string(frame) + ".png", Image(16, 12, 3, 99));
        write(folder + "/mesh/scan_" + std::to_string(frame + 9) + ".obj", quadObj(0.1 * frame));
      }
    }
    options.source = *this / "in";
    options.folder = *this / "out";
    options.up = WorldAxis::Y;
    options.fps = 25;
    options.sequences = {{"walk", "walk"}, {"run", "run"}};
    options.loops = {"walk", "run"};
  }
  Result<ImportSummary> run() const { return importCapture(options, platform::openVideoFile); }
  Result<Capture> open(MeshNeed need) const {
    return mattes::openCapture(options.folder, platform::openVideoFile, {}, need, MatteNeed::None);
  }
  ImportOptions options;
};

bool says(const std::vector<std::string>& lines, const std::string& part) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const auto& line) { return line.find(part) != std::string::npos; });
}

TEST(ImportClasses, TheCaptureHasLoopsClassesAndTheMeshesInOrder) {
  ImportWithMeshes files;
  files.options.classes = {parseClassOption("l:speed_mps=walk,run").value(),
                           parseClassOption("m:a,b=walk:1/2,run:3/4").value()};
  ASSERT_EQ(files.options.check(), "");
  const auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(says(summary.value().done, "sequence walk: 3 frames, a loop, 0 cameras with mattes, 3 meshes"));
  EXPECT_TRUE(says(summary.value().done, "meshes: one that moves"));
  const auto opened = files.open(MeshNeed::ConstantTopology);
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  const Capture& capture = opened.value();
  EXPECT_TRUE(capture.sequences[1].loop);
  ASSERT_EQ(capture.classes.size(), 2u);
  EXPECT_EQ(capture.classes[0].name, "l");
  EXPECT_TRUE(capture.classes[0].members[1].parameter.empty());
  EXPECT_EQ(capture.classes[1].parameters, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(capture.classes[1].members[1].parameter, (std::vector<double>{3, 4}));
  for (uint32_t frame = 0; frame < 3; ++frame) {
    const auto positions = readMeshFrame(capture, capture.sequences[0], frame);
    ASSERT_TRUE(positions.ok()) << positions.error().message;
    EXPECT_NEAR(positions.value()[0].z, 0.1f * float(frame), 1e-6) << "scan_9, scan_10, scan_11";
  }
}

TEST(ImportClasses, MeshesOfAnotherTopologyAreDeclared) {
  ImportWithMeshes files;
  files.write("in/run/mesh/scan_11.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n"));
  const auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(says(summary.value().done, "another topology in every frame"));
  const auto capture = files.open(MeshNeed::AnySurface);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_EQ(capture.value().meshes, CaptureMeshes::PerFrame);
}

TEST(ImportClasses, AMissingMeshIsNamed) {
  ImportWithMeshes files;
  files.remove("in/run/mesh/scan_10.obj");
  expectError(files.run(), ErrorId::FileMissing, "in/run/mesh/scan_10.obj");
  EXPECT_FALSE(std::filesystem::exists(files.options.folder));
}

TEST(ImportClasses, MeshesThatDoNotFollowTheCamerasAreWarnedOf) {
  ImportWithMeshes files;
  files.options.metres_per_unit = 0.001;
  const auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(says(summary.value().warnings, "meshes are neither turned nor scaled"));
  files.remove("out");
  files.remove("in/run/mesh");
  files.write("in/run/mesh/tracked.abc", std::string("x"));
  EXPECT_TRUE(says(files.run().value().warnings, "in/run/mesh: no .obj, .ply, .glb or .gltf in it"));
}

TEST(ImportClasses, ChecksNamesBeforeItReads) {
  ImportWithMeshes files;
  files.options.loops = {"walk", "jump"};
  EXPECT_NE(files.options.check().find("no sequence \"jump\""), std::string::npos);
  files.options.loops = {};
  files.options.classes = {parseClassOption("l:speed_mps=walk,jump").value()};
  EXPECT_NE(files.options.check().find("choose among: walk, run"), std::string::npos) << files.options.check();
  files.options.sequences = {};
  EXPECT_NE(files.options.check().find("--sequences NAME=FOLDER"), std::string::npos);
}

}  // namespace
}  // namespace fourdvt::capture

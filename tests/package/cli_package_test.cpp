// SPDX-License-Identifier: Apache-2.0
// Damaged character folders: inspect and render end with exit code 1 and one line that names the damaged file.
#include <gtest/gtest.h>

#include <filesystem>

#include "../unit/character_files.h"
#include "command.h"

namespace fourdvt::test {
namespace {

namespace fs = std::filesystem;

class DamagedPackage : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    good_ = scratch("package") + "/box";
    baked_ = fourdvt("bake " + smallCapture("package-capture", 8) + " -o " + good_ +
                     " --texture 128 --layers 2 --gop 4 --renditions highest");
  }
  void SetUp() override {
    ASSERT_EQ(baked_.code, 0) << baked_.output;
    folder = copyOf(good_, "damaged");
    manifest = folder + "/character.gltf";
    video = onlyFile(folder, ".mp4");
    stream = fileNamed(folder, "turn.bin");
    ASSERT_TRUE(exists(video) && exists(stream)) << video << " " << stream;
  }
  void expectBroken(const std::string& file, bool render_too = true) {
    const std::string name = fs::path(file).filename().string();
    const Outcome inspect = fourdvt("inspect " + folder);
    EXPECT_EQ(inspect.code, 1) << inspect.output;
    EXPECT_TRUE(isOneLineWith(inspect, name)) << inspect.output;
    if (!render_too) return;
    const std::string picture = folder + "/out.png";
    const Outcome render = fourdvt("render " + folder + " --frame 6 -o " + picture);
    EXPECT_EQ(render.code, 1) << render.output;
    EXPECT_TRUE(isOneLineWith(render, name)) << render.output;
    EXPECT_FALSE(exists(picture));
  }
  std::string folder, manifest, video, stream;

 private:
  static inline std::string good_;
  static inline Outcome baked_;
};

TEST_F(DamagedPackage, IntactOneIsFine) {
  const Outcome inspect = fourdvt("inspect " + folder);
  EXPECT_EQ(inspect.code, 0) << inspect.output;
}

TEST_F(DamagedPackage, NoManifest) {
  fs::remove(manifest);
  expectBroken(manifest);
}

TEST_F(DamagedPackage, TruncatedManifest) {
  truncateTo(manifest, 0.6);
  expectBroken(manifest);
}

TEST_F(DamagedPackage, ManifestOfPlainGltf) {
  writeText(manifest, R"({"asset": {"version": "2.0"}})");
  expectBroken(manifest);
}

TEST_F(DamagedPackage, ManifestWithoutFrames) {
  ASSERT_EQ(shell("sed -i -E 's/(\"(frameCount|frames|frame_count)\" *: *)8/\\10/' " + manifest).code, 0);
  expectBroken(manifest);
}

TEST_F(DamagedPackage, NoVideo) {
  fs::remove(video);
  expectBroken(video);
}

TEST_F(DamagedPackage, TruncatedVideo) {
  truncateTo(video, 0.7);
  expectBroken(video);
}

TEST_F(DamagedPackage, OverwrittenVideoSamples) {
  const uint64_t size = fs::file_size(video);
  damage(video, size / 3, size - size / 3);
  expectBroken(video);
}

TEST_F(DamagedPackage, NoStream) {
  fs::remove(stream);
  expectBroken(stream);
}

TEST_F(DamagedPackage, TruncatedStreamHeader) {
  fs::resize_file(stream, 20);
  expectBroken(stream);
}

TEST_F(DamagedPackage, TruncatedStreamChunk) {
  truncateTo(stream, 0.9);
  expectBroken(stream);
}

TEST_F(DamagedPackage, OverwrittenStreamMagic) {
  damage(stream, 0, 4);
  expectBroken(stream);
}

TEST_F(DamagedPackage, OverwrittenStreamChunks) {
  const uint64_t size = fs::file_size(stream);
  damage(stream, size / 2, size - size / 2);
  expectBroken(stream);
}

TEST_F(DamagedPackage, MissingPosterIsFoundByInspect) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().stem() == "poster") fs::remove(entry.path());
  expectBroken("poster", false);
}

TEST_F(DamagedPackage, MotionGraphThatIsMissingOrNone) {
  const std::string graph = folder + "/graph.bin", hash = "052c9e7cec411035";  // of 100 times "x"
  const std::string named = R"("graph": {"uri": "graph.bin", "byteLength": 100, "hash": ")" + hash + "\"}, ";
  ASSERT_EQ(shell("sed -i 's/\"groundY\"/" + named + "\"groundY\"/' " + manifest).code, 0);
  expectBroken(graph, false);
  writeText(graph, std::string(99, 'x'));
  expectBroken(graph, false);
  for (const char text : {'y', 'x'}) {  // wrong hash; no graph
    writeText(graph, std::string(100, text));
    expectBroken(graph, false);
  }
}

TEST_F(DamagedPackage, UnknownSequenceFrameAndCamera) {
  for (const std::string& wrong :
       {std::string("--sequence fly"), std::string("--frame 8"), std::string("--camera cam99")}) {
    const Outcome render = fourdvt("render " + folder + " " + wrong + " -o " + folder + "/out.png");
    EXPECT_EQ(render.code, 1);
    EXPECT_TRUE(isOneLineWith(render, folder)) << render.output;
  }
}

TEST_F(DamagedPackage, PictureThatCannotBeWritten) {
  const Outcome render = fourdvt("render " + folder + " -o " + folder + "/no/such/folder.png");
  EXPECT_EQ(render.code, 1);
  EXPECT_TRUE(isOneLineWith(render, "/no/such/folder.png")) << render.output;
}

}  // namespace
}  // namespace fourdvt::test

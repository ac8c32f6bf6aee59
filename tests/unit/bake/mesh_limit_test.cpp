// SPDX-License-Identifier: Apache-2.0
// Meshes too large for players' textures are rejected before the bake starts its work.
#include <gtest/gtest.h>

#include "bake/stages/stages.h"
#include "capture_fixture.h"
#include "render/character_model.h"

using namespace fourdvt;
using namespace fourdvt::bake;

namespace {

// A wavy square of cells² · 2 faces with UVs.
std::string gridObj(int cells) {
  std::string text;
  for (int y = 0; y <= cells; ++y)
    for (int x = 0; x <= cells; ++x) {
      const double u = double(x) / cells, v = double(y) / cells;
      text += "v " + std::to_string(u) + " " + std::to_string(v) + " " + std::to_string(0.1 * u * v) + "\nvt " +
              std::to_string(u) + " " + std::to_string(v) + "\n";
    }
  const auto corner = [](int i) { return std::to_string(i) + "/" + std::to_string(i) + " "; };
  for (int y = 0; y < cells; ++y)
    for (int x = 0; x < cells; ++x) {
      const int a = y * (cells + 1) + x + 1, b = a + cells + 1;
      text += "f " + corner(a) + corner(a + 1) + corner(b + 1) + corner(b) + "\n";
    }
  return text;
}

constexpr int kTooManyCells = 296;  // 175,232 faces

Result<Job> validated(const std::string& capture, int faces = 0) {
  BakeOptions options;
  options.capture_folder = capture;
  options.character_folder = capture + "/../" + std::filesystem::path(capture).filename().string() + "_character";
  options.cameras.faces = faces;
  options.texture = 128;
  BakeEnvironment environment;
  environment.open_video = platform::openVideoFile;
  auto job = validate(options, environment);
  std::filesystem::remove_all(options.character_folder + ".work");
  return job;
}

package::Character charactersOf(uint32_t vertices, uint32_t faces) {
  package::Character character;
  character.vertex_count = vertices;
  character.face_count = faces;
  return character;
}

TEST(MeshLimit, IsWhereTheRendererRefuses) {
  auto device = gpu::createNullDevice();  // its textures have 4096 texels a side
  ASSERT_EQ(device->caps().max_texture_size, int(kPlayersTextureSide));
  for (const auto& [vertices, faces] : {std::pair<uint32_t, uint32_t>{100, 174745},
                                        {100, 174746},
                                        {149799, 149796},
                                        {149800, 149796},
                                        {524288, 9},
                                        {524289, 9}}) {
    const bool drawn = render::CharacterModel::createForSurfaces(*device, charactersOf(vertices, faces)).ok();
    EXPECT_EQ(checkSurface("scan.ply", vertices, faces).ok(), drawn) << vertices << " " << faces;
  }
  EXPECT_TRUE(checkLayeredMesh("mesh.obj", 90000, 174762).ok());
  EXPECT_FALSE(checkLayeredMesh("mesh.obj", 90000, 174763).ok());
  EXPECT_FALSE(checkLayeredMesh("mesh.obj", 524289, 9).ok());
}

TEST(MeshLimit, LayeredBakeNamesMeshAndRemedy) {
  const capture::SmallCapture capture;
  capture.write("capture.json", std::string(R"({"fps": 25, "sequences": [{"name": "walk", "frames": 1}]})"));
  capture.write("walk/mesh/000000.obj", gridObj(kTooManyCells));
  const auto job = validated(capture.path());
  capture::expectError(job, ErrorId::InvalidArgument, "walk/mesh/000000.obj: 175232 faces");
  capture::expectError(job, ErrorId::InvalidArgument, "simplify the mesh to at most 174762 faces");
}

TEST(MeshLimit, SurfacesAreRefusedUnlessTheyAreSimplified) {
  const capture::BareCapture capture;
  for (int frame = 0; frame < capture::SmallCapture::kFrames; ++frame)
    capture.write("walk/mesh/" + capture::numbered(frame, ".obj"), gridObj(frame == 1 ? kTooManyCells : 2));
  const auto whole = validated(capture.path());
  capture::expectError(whole, ErrorId::InvalidArgument, "walk/mesh/000001.obj: 175232 faces");
  capture::expectError(whole, ErrorId::InvalidArgument, "--faces");
  const auto simplified = validated(capture.path(), 10000);
  EXPECT_TRUE(simplified.ok()) << simplified.error().message;
}

}  // namespace

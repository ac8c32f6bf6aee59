// SPDX-License-Identifier: Apache-2.0
// Meshes of constant topology whose faces or whose vertices differ from those of the first frame.
#include "capture/mesh_sequence.h"

#include <algorithm>
#include <numeric>
#include <random>

#include "capture_fixture.h"

namespace fourdvt::capture {
namespace {

constexpr uint32_t kSheetSide = 24;

// A wavy sheet of kSheetSide × kSheetSide vertices; `bend` moves it.
Positions sheet(float bend) {
  Positions out;
  for (uint32_t y = 0; y < kSheetSide; ++y)
    for (uint32_t x = 0; x < kSheetSide; ++x)
      out.emplace_back(0.1f * float(x), 0.1f * float(y) + bend * std::sin(0.3f * float(x)),
                       bend * float(x * y) * 0.02f);
  return out;
}

std::vector<glm::uvec3> sheetFaces() {
  std::vector<glm::uvec3> out;
  for (uint32_t y = 0; y + 1 < kSheetSide; ++y)
    for (uint32_t x = 0; x + 1 < kSheetSide; ++x) {
      const uint32_t i = y * kSheetSide + x;
      out.emplace_back(i, i + 1, i + kSheetSide);
      out.emplace_back(i + 1, i + kSheetSide + 1, i + kSheetSide);
    }
  return out;
}

// Permutes the first `count` vertices.
Positions shuffled(Positions positions, size_t count) {
  std::shuffle(positions.begin(), positions.begin() + long(count), std::mt19937(5));
  return positions;
}

std::string objOf(const Positions& positions, const std::vector<glm::uvec3>& faces) {
  std::string text = "vt 0 0\n";
  for (const glm::vec3& p : positions)
    text += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  for (const glm::uvec3& f : faces)
    text += "f " + std::to_string(f.x + 1) + "/1 " + std::to_string(f.y + 1) + "/1 " + std::to_string(f.z + 1) + "/1\n";
  return text;
}

TEST(MeshOrder, EdgesOfShuffledVerticesGrow) {
  const Positions still = sheet(0);
  const EdgeLengths edges(sheetFaces(), still);
  EXPECT_EQ(edges.grown(still), 0);
  EXPECT_EQ(edges.grown(sheet(1.5f)), 0) << "a surface that moves";
  Positions larger = still;
  for (glm::vec3& p : larger) p = 40.0f * p + glm::vec3(7);
  EXPECT_EQ(edges.grown(larger), 0) << "the whole mesh grows";
  EXPECT_GT(edges.grown(shuffled(still, still.size())), 0.6);
  EXPECT_GT(edges.grown(shuffled(still, still.size() / 4)), kMaxGrown);
  Positions torn = still;
  torn[5] = {9, 9, 9};
  EXPECT_LT(edges.grown(torn), kMaxGrown) << "one vertex";
}

TEST(MeshOrder, MeshesWithoutSizeHaveNoOrder) {
  const Positions point(3, glm::vec3(1));
  EXPECT_EQ(EdgeLengths({{0, 1, 2}}, point).grown(sheet(0)), 0);
  EXPECT_EQ(EdgeLengths({{0, 1, 2}}, sheet(0)).grown(point), 0);
  EXPECT_EQ(EdgeLengths({}, {}).grown({}), 0);
}

void expectFrame(const SmallCapture& files, const std::string& words) {
  const auto capture = files.open();
  expectError(capture, ErrorId::MeshTopology, files / "walk/mesh/000002.obj");
  if (capture.ok()) return;
  for (const std::string& part :
       {std::string("frame 2 of \"walk\""), words, std::string("\"topology\": \"per-frame\"")})
    EXPECT_NE(capture.error().message.find(part), std::string::npos) << capture.error().message;
}

TEST(MeshOrder, FramesThatDifferAreNamed) {
  SmallCapture files;
  std::vector<glm::uvec3> faces = sheetFaces();
  for (int k = 0; k < 3; ++k) files.write("walk/mesh/" + numbered(k, ".obj"), objOf(sheet(0.2f * float(k)), faces));
  EXPECT_TRUE(files.open().ok());
  files.write("walk/mesh/000002.obj", objOf(shuffled(sheet(0.4f), 500), faces));
  expectFrame(files, "its vertices in another order than the first one");
  files.write("walk/mesh/000002.obj", "# continued \\\n\n" + objOf(shuffled(sheet(0.4f), 500), faces));  // parsed whole
  expectFrame(files, "its vertices in another order than the first one");
  std::swap(faces[0], faces[1]);
  files.write("walk/mesh/000002.obj", objOf(sheet(0.4f), faces));
  expectFrame(files, "other faces or UVs than the first one, or in another order");
  faces.pop_back();
  files.write("walk/mesh/000002.obj", objOf(sheet(0.4f), faces));
  expectFrame(files, "has 576 vertices and 1057 triangles, not 576 and 1058");
}

// The first sequence's order applies to all.
TEST(MeshOrder, SequencesAreComparedWithEachOther) {
  SmallCapture files;
  files.write("capture.json", std::string(R"({"fps": 25, "sequences": [{"name": "walk", "frames": 3}, {"name": "run",
                                             "frames": 1}]})"));
  for (int k = 0; k < 3; ++k) files.write("walk/mesh/" + numbered(k, ".obj"), objOf(sheet(0), sheetFaces()));
  files.write("run/mesh/000000.obj", objOf(shuffled(sheet(0), 500), sheetFaces()));
  expectError(files.open(), ErrorId::MeshTopology, files / "run/mesh/000000.obj");
}

// A quad that becomes concave keeps its first frame's triangles.
TEST(MeshOrder, PolygonsThatBecomeConcave) {
  SmallCapture files;
  const std::string rest = "vt 0 0\nf 2/1 3/1 4/1 1/1\n";
  files.write("walk/mesh/000001.obj", "v 0 0 0\nv 1 0 0\nv 0.2 0.2 0\nv 0 1 0\n" + rest);
  for (const int k : {0, 2})
    files.write("walk/mesh/" + numbered(k, ".obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n" + rest);
  const auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_TRUE(readMeshFrame(capture.value(), capture.value().sequences[0], 1).ok());
}

// Meshes of constant topology may start at any number, and PLY is an error where UVs are required.
TEST(MeshOrder, ConstantTopologyByAnyNumber) {
  SmallCapture files;
  files.remove("walk/mesh");
  for (int k = 0; k < 3; ++k) files.write("walk/mesh/mesh.f100" + std::to_string(k + 1) + ".obj", quadObj(0.1 * k));
  const auto capture = files.open();
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_NEAR(readMeshFrame(capture.value(), capture.value().sequences[0], 2).value()[0].z, 0.2, 1e-6);
  files.remove("walk/mesh");
  for (int k = 0; k < 3; ++k) files.write("walk/mesh/" + numbered(k, ".ply"), std::string("ply\n"));
  expectError(files.open(), ErrorId::Unsupported, files / "walk/mesh/000000.ply");
}

}  // namespace
}  // namespace fourdvt::capture

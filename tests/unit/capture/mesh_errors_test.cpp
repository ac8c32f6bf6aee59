// SPDX-License-Identifier: Apache-2.0
// Damaged or misnamed mesh files: one message that names the file and the remedy.
#include "capture/mesh_file.h"
#include "capture_fixture.h"
#include "mesh_files.h"

namespace fourdvt::capture {
namespace {

void expectMessage(const std::string& bytes, const std::string& path, ErrorId id, const std::string& words) {
  const auto mesh = parseMesh(bytes, path);
  expectError(mesh, id, path + ":");
  if (!mesh.ok()) {
    EXPECT_NE(mesh.error().message.find(words), std::string::npos) << mesh.error().message;
    EXPECT_NE(mesh.error().message.find(";"), std::string::npos) << "no remedy: " << mesh.error().message;
  }
}

std::string glbWith(const std::string& primitives, const std::string& nodes = R"([{"mesh": 0}])") {
  return glb(gltfJson(squareMesh(), nodes, primitives), gltfBuffer(squareMesh()));
}

TEST(MeshErrors, NanAndInfinity) {
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    TriangleMesh mesh = squareMesh();
    mesh.positions[4].y = bad;
    expectMessage(plyBytes(mesh), "a.ply", ErrorId::MeshNotFinite, "not finite");
    expectMessage(glbBytes(mesh), "a.glb", ErrorId::MeshNotFinite, "not finite");
    const auto obj = parseMesh(objText(mesh), "a.obj");
    expectError(obj, ErrorId::MeshNotFinite, "a.obj:7: ");
  }
  expectMessage(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n1e300 nan 0\n3 0 0 0\n",
      "a.ply", ErrorId::MeshNotFinite, "not finite");
}

TEST(MeshErrors, NoFaces) {
  const TriangleMesh points{squareMesh().positions, {}};
  expectMessage(objText(points), "a.obj", ErrorId::MeshIndex, "no faces");
  expectMessage(plyBytes(points), "a.ply", ErrorId::MeshIndex, "no faces");
  expectMessage(glbWith(R"([{"attributes": {"POSITION": 0}, "mode": 0}])"), "a.glb", ErrorId::MeshIndex, "no faces");
  expectMessage(R"({"asset": {"version": "2.0"}})", "a.gltf", ErrorId::MeshIndex, "no faces");
}

// Skips elements other than the surface's; rejects faces under another name instead of losing them silently.
TEST(MeshErrors, PlyElementsAreNamed) {
  const std::string vertices =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string edges = "element edge 1\nproperty int vertex1\nproperty int vertex2\n";
  expectMessage(vertices + edges + "end_header\n0 0 0\n1 0 0\n0 1 0\n0 1\n", "a.ply", ErrorId::MeshIndex,
                "no faces in it, but vertex, edge");
  expectMessage(
      vertices + "element polys 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
      "a.ply", ErrorId::Unsupported, "faces in the element \"polys\"");
  expectMessage(
      vertices +
          "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n",
      "a.ply", ErrorId::MeshIndex, "out of range");
}

TEST(MeshErrors, IndexOutOfRange) {
  TriangleMesh mesh = squareMesh();
  for (const uint32_t bad : {5u, 0x7fffffffu, 0xffffffffu}) {
    mesh.faces[1].z = bad;
    expectMessage(plyBytes(mesh), "a.ply", ErrorId::MeshIndex, "out of range");
    expectMessage(glbBytes(mesh), "a.glb", ErrorId::MeshIndex, "out of range");
    expectError(parseMesh(objText(mesh), "a.obj"), ErrorId::MeshIndex, "a.obj:9: ");
  }
}

// An index beyond a primitive's own vertices must not reach the next primitive's.
TEST(MeshErrors, IndexIntoAnotherPrimitive) {
  TriangleMesh mesh = squareMesh();
  mesh.faces[1].z = 5;
  std::string json = gltfJson(mesh, R"([{"mesh": 0}])",
                              R"([{"attributes": {"POSITION": 0}, "indices": 1}, {"attributes": {"POSITION": 2}}])");
  json.insert(json.size() - 2, R"(, {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 5})");
  expectMessage(glb(json, gltfBuffer(mesh)), "a.glb", ErrorId::MeshIndex, "out of range");
  const auto right = parseMesh(glb(replaced(json, R"("indices": 1)", R"("mode": 4)"), gltfBuffer(mesh)), "a.glb");
  ASSERT_TRUE(right.ok()) << right.error().message;
  EXPECT_EQ(right.value().positions.size(), 10u);
}

// Truncated at any length, a file is rejected; except for the last bytes, as truncated.
TEST(MeshErrors, TruncatedFiles) {
  const std::string ply = plyBytes(squareMesh()), binary = glbBytes(squareMesh());
  const std::string ascii =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2";
  for (size_t size = 4; size < ply.size(); ++size)
    expectMessage(ply.substr(0, size), "a.ply", ErrorId::FileUnreadable, "truncated");
  for (size_t size = 4; size < ascii.size(); ++size)
    expectMessage(ascii.substr(0, size), "a.ply", ErrorId::FileUnreadable, "truncated");
  for (size_t size = 4; size < binary.size(); ++size)
    expectMessage(binary.substr(0, size), "a.glb", ErrorId::FileUnreadable, "truncated");
  const std::string json = gltfJson(squareMesh());
  for (size_t size = 1; size < json.size(); size += 7)
    expectMessage(json.substr(0, size), "a.gltf", ErrorId::FileUnreadable, "truncated");
}

// Counts in a header are checked against the bytes that follow.
TEST(MeshErrors, AnnouncedCountsAreNotBelieved) {
  const std::string ply = plyBytes(squareMesh());
  for (const std::string count : {"4000000000", "99999999999999999"})
    expectMessage(replaced(ply, "vertex 5", "vertex " + count), "a.ply", ErrorId::FileUnreadable, "truncated");
  expectMessage(replaced(ply, "vertex 5", "vertex -5"), "a.ply", ErrorId::FileUnreadable, "no count");
  const std::string json = gltfJson(squareMesh()), buffer = gltfBuffer(squareMesh());
  for (const std::string wrong : {"4000000000", "9000000000000000", "6", "0", "-1", "\"5\"", "1e300"})
    expectMessage(glb(replaced(json, "\"count\": 5", "\"count\": " + wrong), buffer), "a.glb", ErrorId::FileUnreadable,
                  "positions cannot be read");
  expectMessage(glb(replaced(json, "\"byteOffset\": 60", "\"byteOffset\": 9000000000000000"), buffer), "a.glb",
                ErrorId::FileUnreadable, "indices cannot be read");
  expectMessage(glb(replaced(json, "\"byteLength\": 84", "\"byteLength\": 88"), buffer), "a.glb",
                ErrorId::FileUnreadable, "shorter than it says");
}

TEST(MeshErrors, BrokenPlyHeaders) {
  const std::string ply = plyBytes(squareMesh());
  expectMessage(replaced(ply, "format binary_little_endian", "format middle"), "a.ply", ErrorId::FileUnreadable,
                "format is none of");
  expectMessage(replaced(ply, "format binary_little_endian 1.0\n", ""), "a.ply", ErrorId::FileUnreadable,
                "does not say its format");
  expectMessage(replaced(ply, "float z", "half z"), "a.ply", ErrorId::FileUnreadable, "cannot be understood");
  expectMessage(replaced(ply, "float z", "float w"), "a.ply", ErrorId::FileUnreadable, "no x, y and z");
  expectMessage(replaced(ply, "element face", "elephant face"), "a.ply", ErrorId::FileUnreadable,
                "none of PLY's words");
  expectMessage(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n1 two 3\n",
      "a.ply", ErrorId::FileUnreadable, "where a number is due");
  expectMessage("ply\nformat ascii 1.0\nelement face 1\nproperty list char int vertex_indices\nend_header\n-3 0 1 2\n",
                "a.ply", ErrorId::FileUnreadable, "no valid length");
}

TEST(MeshErrors, CompressionThatIsNotRead) {
  expectMessage(glbWith(R"([{"attributes": {"POSITION": 0}, "extensions":
                            {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}}])"),
                "a.glb", ErrorId::Unsupported, "compressed with Draco; export without compression");
  const std::string json = replaced(gltfJson(squareMesh()), R"({"buffer": 0,)",
                                    R"({"extensions": {"EXT_meshopt_compression": {}}, "buffer": 0,)");
  expectMessage(glb(json, gltfBuffer(squareMesh())), "a.glb", ErrorId::Unsupported, "compressed with meshopt");
  expectMessage(
      glb(replaced(gltfJson(squareMesh()), R"("count": 5)", R"("sparse": {}, "count": 5)"), gltfBuffer(squareMesh())),
      "a.glb", ErrorId::FileUnreadable, "positions cannot be read");
}

TEST(MeshErrors, BrokenGltf) {
  const std::string plain = R"([{"attributes": {"POSITION": 0}, "indices": 1}])";
  expectMessage(glbWith(plain, R"([{"mesh": 0, "skin": 0}])"), "a.glb", ErrorId::FileUnreadable, "a skin is missing");
  expectMessage(glbWith(plain, R"([{"mesh": 0, "weights": [0, "x"]}])"), "a.glb", ErrorId::FileUnreadable, "weights");
  expectMessage(glbWith(plain, R"([{"children": [1]}, {"children": [0], "mesh": 0}])"), "a.glb",
                ErrorId::FileUnreadable, "do not form a tree");
  expectMessage(glbWith(plain, R"([{"children": [0, 0]}])"), "a.glb", ErrorId::FileUnreadable, "do not form a tree");
  expectMessage(glbWith(plain, R"([{"children": [7]}])"), "a.glb", ErrorId::FileUnreadable, "a node is missing");
  expectMessage(glbWith(plain, R"([{"mesh": 3}])"), "a.glb", ErrorId::FileUnreadable, "a mesh is missing");
  expectMessage(glbWith(plain, R"([{"mesh": 0, "scale": [1, 1]}])"), "a.glb", ErrorId::FileUnreadable,
                "transform cannot be read");
  expectMessage(glbWith(R"([{"attributes": {"NORMAL": 0}}])"), "a.glb", ErrorId::FileUnreadable,
                "positions cannot be read");
  std::string old = glbBytes(squareMesh());
  old[4] = 1;
  expectMessage(old, "a.glb", ErrorId::Unsupported, "GLB version 1");
  expectMessage(R"({"asset": {"version": "1.0"}})", "a.gltf", ErrorId::Unsupported, "no glTF 2.0");
}

// A node that repeats a mesh takes a few bytes, but multiplies vertices.
TEST(MeshErrors, RepeatedMeshesAreBounded) {
  std::string children = "1", nodes, parts = R"({"attributes": {"POSITION": 0}, "mode": 6})";
  for (int i = 2; i <= 20000; ++i) children.append(",").append(std::to_string(i));
  for (int i = 1; i <= 20000; ++i) nodes += ",{\"mesh\":0}";
  for (int i = 1; i <= 20; ++i) parts += R"(,{"attributes": {"POSITION": 0}, "mode": 5})";
  expectMessage(glbWith("[" + parts + "]", "[{\"children\": [" + children + "]}" + nodes + "]"), "a.glb",
                ErrorId::Unsupported, "too many times");
}

TEST(MeshErrors, EmptyFilesAndWrongNames) {
  for (const char* path : {"a.obj", "a.ply", "a.glb", "a.gltf"})
    expectMessage("", path, ErrorId::FileUnreadable, "the file is empty");
  const TriangleMesh mesh = squareMesh();
  expectMessage(plyBytes(mesh), "a.obj", ErrorId::FileUnreadable, "holds PLY, not OBJ; rename it to end in .ply");
  expectMessage(glbBytes(mesh), "a.ply", ErrorId::FileUnreadable, "holds GLB, not PLY; rename it to end in .glb");
  expectMessage(gltfJson(mesh), "a.glb", ErrorId::FileUnreadable, "holds glTF, not GLB; rename it to end in .gltf");
  expectMessage(objText(mesh), "a.ply", ErrorId::FileUnreadable, "does not begin as PLY does");
  expectMessage(objText(mesh), "a.glb", ErrorId::FileUnreadable, "does not begin as GLB does");
  expectMessage("a mesh", "a.xyz", ErrorId::Unsupported, ".obj, .ply, .glb and .gltf");
  expectMessage("Kaydara FBX Binary", "a.fbx", ErrorId::Unsupported,
                "FBX is not read; export one OBJ, PLY or glTF file");
  expectMessage("Ogawa", "a.ABC", ErrorId::Unsupported, "Alembic is not read");
  expectMessage("PXR-USDC", "a.usdc", ErrorId::Unsupported, "USD is not read");
  expectMessage("BLENDER", "a.blend", ErrorId::Unsupported, "Blender is not read");
  expectMessage("Kaydara FBX Binary", "a.obj", ErrorId::MeshIndex, "no vertices");
  TempFolder folder;
  expectError(readMeshFile(folder / "gone.ply"), ErrorId::FileMissing, folder / "gone.ply");
  expectError(readMeshFile(folder.path()), ErrorId::FileMissing, folder.path());
}

}  // namespace
}  // namespace fourdvt::capture

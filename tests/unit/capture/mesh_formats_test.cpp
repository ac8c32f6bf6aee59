// SPDX-License-Identifier: Apache-2.0
// OBJ, PLY, GLB and glTF of one mesh give one mesh, and sequences of changing topology give one capture.
#include "capture/mesh_file.h"
#include "capture_fixture.h"
#include "mattes/frame_reader.h"
#include "mesh_files.h"

namespace fourdvt::capture {
namespace {

void expectSame(const Result<TriangleMesh>& read, const TriangleMesh& mesh) {
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read.value().positions, mesh.positions);
  EXPECT_EQ(read.value().faces, mesh.faces);
}

TEST(MeshFormats, OneMeshInAllFormats) {
  const TriangleMesh mesh = squareMesh();
  expectSame(parseMesh(objText(mesh), "a.obj"), mesh);
  expectSame(parseMesh(plyBytes(mesh), "a.ply"), mesh);
  expectSame(parseMesh(plyBytes(mesh), "A.PLY"), mesh);
  expectSame(parseMesh(glbBytes(mesh), "a.glb"), mesh);
}

TEST(MeshFormats, ObjWithUvsNormalsAndPolygons) {
  const auto mesh = parseMesh(
      "v 0 0 0 1 0 0\r\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 7 7\nvn 0 0 1\np 1\nl 1 2\n"
      "f 1/1/1 2/1/1 3/1/1 -1/1/1\nf 1//1 2//1 3//1\nf 1/9 2/9 3/9\n",
      "a.obj");
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  EXPECT_EQ(mesh.value().positions.size(), 4u);
  EXPECT_EQ(mesh.value().faces, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {0, 1, 2}}));
}

// PLY files of scanners and modelling programs: faces first, other elements, colours, doubles, a quad, a line.
TEST(MeshFormats, AsciiPlyWithMoreThanItNeeds) {
  const auto mesh = parseMesh(
      "ply\r\nformat ascii 1.0\ncomment by hand\nobj_info x\nelement face 3\nproperty uchar quality\n"
      "property list uchar float texcoord\nproperty list uint8 int32 vertex_index\nelement edge 1\n"
      "property int a\nelement vertex 4\nproperty float nx\nproperty double z\nproperty double y\n"
      "property double x\nproperty uchar red\nend_header\n"
      "9 3 0 0.5 1 4 0 1 2 3\n9 0 2 0 1\n9 0 3 3 2 1\n5\n0 3 2 1 255\n0 3 2 2 255\n0 3 3 2 255\n0 3 3 1 255",
      "a.ply");
  expectSame(mesh, {{{1, 2, 3}, {2, 2, 3}, {2, 3, 3}, {1, 3, 3}}, {{0, 1, 2}, {0, 2, 3}, {3, 2, 1}}});
}

// Strips as in Stanford's scans: -1 separates them, every second triangle is reversed, a repeated vertex only joins two
// parts.
TEST(MeshFormats, PlyStrips) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n";
  const auto faces = [&](const std::string& strips) {
    const auto mesh = parseMesh(head + strips, "a.ply");
    EXPECT_TRUE(mesh.ok()) << mesh.error().message;
    return mesh.ok() ? mesh.value().faces : std::vector<glm::uvec3>();
  };
  EXPECT_EQ(faces("5 0 1 2 3 4\n"), (std::vector<glm::uvec3>{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}}));
  EXPECT_EQ(faces("8 0 1 2 -1 1 3 2 4\n"), (std::vector<glm::uvec3>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
  EXPECT_EQ(faces("11 -1 -1 3 4 -1 0 1 2 2 3 -1\n"), (std::vector<glm::uvec3>{{0, 1, 2}}));
  EXPECT_EQ(faces("6 0 1 2 2 3 4\n"), (std::vector<glm::uvec3>{{0, 1, 2}, {3, 2, 4}}));
}

// An L-shaped polygon whose first corner does not see all of it, in each format with polygons; in PLY before its
// vertices.
TEST(MeshFormats, ConcavePolygons) {
  const std::string obj = "v 0 2 0\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\n";
  const std::vector<TriangleMesh> meshes{
      parseMesh(obj + "f 6 1 2 3 4 5\n", "a.obj").take(), parseMesh(obj + "f 3 4 5 6 1 2\n", "a.obj").take(),
      parseMesh("ply\nformat ascii 1.0\nelement face 2\nproperty list uchar int vertex_index\nelement vertex 6\n"
                "property float x\nproperty float y\nproperty float z\nend_header\n6 3 4 5 0 1 2\n3 0 1 2\n"
                "0 2 0\n0 0 0\n2 0 0\n2 1 0\n1 1 0\n1 2 0\n",
                "a.ply")
          .take()};
  for (const TriangleMesh& mesh : meshes) {
    ASSERT_GE(mesh.faces.size(), 4u);
    double area = 0;
    for (size_t t = 0; t < 4; ++t) {
      const glm::vec3 &a = mesh.positions[mesh.faces[t].x], &b = mesh.positions[mesh.faces[t].y],
                      &c = mesh.positions[mesh.faces[t].z];
      EXPECT_GE(glm::cross(b - a, c - a).z, 0);
      area += 0.5 * glm::cross(b - a, c - a).z;
    }
    EXPECT_NEAR(area, 3, 1e-6);
  }
  EXPECT_EQ(meshes[2].faces.back(), glm::uvec3(0, 1, 2));
}

TEST(MeshFormats, BigEndianPly) {
  const TriangleMesh mesh = squareMesh();
  std::string text = plyBytes(mesh);
  const size_t at = text.find("little");
  text.replace(at, 6, "big");
  size_t byte = text.find("end_header\n") + 11;
  const auto turn = [&](size_t size) {
    std::reverse(text.begin() + long(byte), text.begin() + long(byte + size));
    byte += size;
  };
  for (size_t i = 0; i < 3 * mesh.positions.size(); ++i) turn(4);
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    ++byte;  // the number of corners
    for (int k = 0; k < 3; ++k) turn(4);
  }
  expectSame(parseMesh(text, "a.ply"), mesh);
}

// A node that rotates, scales and mirrors, below one that moves: faces keep their outer side.
TEST(MeshFormats, GltfNodesMoveTheirMeshes) {
  const TriangleMesh mesh = squareMesh();
  const std::string nodes = R"([{"children": [1, 2], "translation": [10, 0, 0]}, {"mesh": 0, "scale": [-2, 1, 1]},
      {"mesh": 0, "matrix": [0,1,0,0, -1,0,0,0, 0,0,1,0, 0,0,5,1]}])";
  const auto read = parseMesh(glb(gltfJson(mesh, nodes), gltfBuffer(mesh)), "a.glb");
  ASSERT_TRUE(read.ok()) << read.error().message;
  ASSERT_EQ(read.value().positions.size(), 10u);
  EXPECT_EQ(read.value().positions[2], glm::vec3(8, 1, 1));
  EXPECT_EQ(read.value().positions[7], glm::vec3(9, 1, 6));
  EXPECT_EQ(read.value().faces, (std::vector<glm::uvec3>{{0, 2, 1}, {0, 3, 2}, {5, 6, 7}, {5, 7, 8}}));
  const std::string turned = R"([{"mesh": 0, "rotation": [0, 0, 0.70710678118654752, 0.70710678118654752]}])";
  const auto quarter = parseMesh(glb(gltfJson(mesh, turned), gltfBuffer(mesh)), "a.glb");
  ASSERT_TRUE(quarter.ok());
  EXPECT_NEAR(glm::distance(quarter.value().positions[1], glm::vec3(0, 1, 1)), 0, 1e-6);
}

// Primitives of several materials share vertices; points and lines are skipped; strips and fans become triangles.
TEST(MeshFormats, GltfPrimitives) {
  const TriangleMesh mesh = squareMesh();
  const std::string parts = R"([{"attributes": {"POSITION": 0}, "indices": 1},
      {"attributes": {"POSITION": 0}, "mode": 0}, {"attributes": {"POSITION": 0}, "mode": 1},
      {"attributes": {"POSITION": 0}, "mode": 5}, {"attributes": {"POSITION": 0}, "mode": 6},
      {"attributes": {"POSITION": 0}, "mode": 4}])";
  const auto read = parseMesh(glb(gltfJson(mesh, R"([{"mesh": 0}])", parts), gltfBuffer(mesh)), "a.glb");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read.value().positions.size(), 5u);
  EXPECT_EQ(read.value().faces,
            (std::vector<glm::uvec3>{
                {0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 1, 2}}));
}

TEST(MeshFormats, GltfWithItsBufferBesideItOrInside) {
  const TriangleMesh mesh = squareMesh();
  TempFolder folder;
  const auto gltf = [&](const std::string& uri) {
    return gltfJson(mesh, R"([{"mesh": 0}])", R"([{"attributes": {"POSITION": 0}, "indices": 1}])", uri);
  };
  folder.write("parts/a b.bin", gltfBuffer(mesh));
  folder.write("a.gltf", gltf("parts/a%20b.bin"));
  expectSame(readMeshFile(folder / "a.gltf"), mesh);
  const std::string one = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAEAAAACAAAA";  // three vertices, a face
  const TriangleMesh triangle{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {{0, 1, 2}}};
  folder.write("b.gltf", gltfJson(triangle, R"([{"mesh": 0}])", R"([{"attributes": {"POSITION": 0}, "indices": 1}])",
                                  "data:application/octet-stream;base64," + one));
  expectSame(readMeshFile(folder / "b.gltf"), triangle);
  folder.write("c.gltf", gltf("gone.bin"));
  expectError(readMeshFile(folder / "c.gltf"), ErrorId::FileMissing, folder / "gone.bin");
  folder.write("d.gltf", gltf("../secret.bin"));
  expectError(readMeshFile(folder / "d.gltf"), ErrorId::Unsupported, folder / "d.gltf");
}

// KHR_mesh_quantization: positions as normalised 16-bit integers.
TEST(MeshFormats, GltfOfIntegerPositions) {
  const std::string json = R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0, "scale": [2, 2, 2]}],
      "extensionsRequired": ["KHR_mesh_quantization"], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
      "buffers": [{"byteLength": 24}], "bufferViews": [{"buffer": 0, "byteLength": 24, "byteStride": 8}],
      "accessors": [{"bufferView": 0, "componentType": 5122, "normalized": true, "type": "VEC3", "count": 3}]})";
  const std::vector<int16_t> values{0, 0, 0, 9, 32767, 0, 0, 9, 0, -32767, 0, 9};
  expectSame(parseMesh(glb(json, rawBytes(values)), "a.glb"), {{{0, 0, 0}, {2, 0, 0}, {0, -2, 0}}, {{0, 1, 2}}});
}

// Distance along z of the nearest face behind each of 96 × 192 points of a plane; 9 where there is none.
std::vector<float> depthOf(const TriangleMesh& mesh) {
  constexpr int kWidth = 96, kHeight = 192;
  std::vector<float> depth(kWidth * kHeight, 9);
  for (const glm::uvec3& face : mesh.faces) {
    std::array<glm::vec3, 3> p;
    for (int k = 0; k < 3; ++k) p[k] = mesh.positions[face[k]] * 96.0f + glm::vec3(48, 0, 0);
    const auto edge = [](glm::vec3 a, glm::vec3 b, glm::vec2 c) {
      return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    };
    const float area = edge(p[0], p[1], p[2]);
    if (area == 0) continue;
    const glm::vec3 low = glm::min(p[0], glm::min(p[1], p[2])), high = glm::max(p[0], glm::max(p[1], p[2]));
    for (int y = std::max(0, int(low.y)); y <= std::min(kHeight - 1, int(high.y)); ++y) {
      for (int x = std::max(0, int(low.x)); x <= std::min(kWidth - 1, int(high.x)); ++x) {
        const glm::vec2 c(x + 0.5f, y + 0.5f);
        const glm::vec3 w = glm::vec3(edge(p[1], p[2], c), edge(p[2], p[0], c), edge(p[0], p[1], c)) / area;
        if (w.x < 0 || w.y < 0 || w.z < 0) continue;
        float& nearest = depth[y * kWidth + x];
        nearest = std::min(nearest, (w.x * p[0].z + w.y * p[1].z + w.z * p[2].z) / 96);
      }
    }
  }
  return depth;
}

BoundingBox boundsOf(const TriangleMesh& mesh) {
  BoundingBox box{mesh.positions[0], mesh.positions[0]};
  for (const glm::vec3& p : mesh.positions) box.min = glm::min(box.min, p), box.max = glm::max(box.max, p);
  return box;
}

// Mesh without the faces in a band of heights, and without vertices that are then unused.
TriangleMesh withoutBand(const TriangleMesh& mesh, float from_m, float to_m) {
  TriangleMesh out;
  std::vector<uint32_t> kept(mesh.positions.size(), 0xffffffff);
  for (glm::uvec3 face : mesh.faces) {
    const float height = mesh.positions[face[0]].y;
    if (height >= from_m && height < to_m) continue;
    for (int k = 0; k < 3; ++k) {
      uint32_t& index = kept[face[k]];
      if (index == 0xffffffff) {
        index = static_cast<uint32_t>(out.positions.size());
        out.positions.push_back(mesh.positions[face[k]]);
      }
      face[k] = index;
    }
    out.faces.push_back(face);
  }
  return out;
}

TEST(MeshFormats, SequencesOfChangingTopologyAgree) {
  const auto sample = mattes::openCapture(kSample, platform::openVideoFile, {"run"});
  ASSERT_TRUE(sample.ok()) << sample.error().message;
  std::vector<TriangleMesh> truth;
  for (uint32_t k = 0; k < 3; ++k) {
    const auto mesh = readSurfaceFrame(sample.value(), sample.value().sequences[0], k);
    ASSERT_TRUE(mesh.ok());
    truth.push_back(withoutBand(mesh.value(), 0.4f * k + 0.2f, 0.4f * k + 0.4f));
  }
  ASSERT_NE(truth[0].positions.size(), truth[1].positions.size());
  for (const std::string extension : {".obj", ".ply", ".glb", ".gltf"}) {
    SCOPED_TRACE(extension);
    BareCapture files;
    for (int k = 0; k < 3; ++k) {
      const std::string name = "walk/mesh/" + numbered(k, extension.c_str());
      if (extension == ".obj") files.write(name, objText(truth[k]));
      if (extension == ".ply") files.write(name, plyBytes(truth[k]));
      if (extension == ".glb") files.write(name, glbBytes(truth[k]));
      if (extension != ".gltf") continue;
      const std::string buffer = numbered(k, ".bin");
      files.write("walk/mesh/" + buffer, gltfBuffer(truth[k]));
      files.write(name,
                  gltfJson(truth[k], R"([{"mesh": 0}])", R"([{"attributes": {"POSITION": 0}, "indices": 1}])", buffer));
    }
    const auto capture = files.openAs(MeshNeed::AnySurface);
    ASSERT_TRUE(capture.ok()) << capture.error().message;
    auto reader = mattes::FrameReader::open(capture.value(), capture.value().sequences[0], platform::openVideoFile);
    ASSERT_TRUE(reader.ok());
    for (int k = 0; k < 3; ++k) {
      auto frame = reader.value()->next();
      ASSERT_TRUE(frame.ok()) << frame.error().message;
      const TriangleMesh read{frame.value().positions, frame.value().faces};
      EXPECT_EQ(read.positions.size(), truth[k].positions.size());
      EXPECT_EQ(read.faces.size(), truth[k].faces.size());
      EXPECT_EQ(boundsOf(read).min, boundsOf(truth[k]).min);
      EXPECT_EQ(boundsOf(read).max, boundsOf(truth[k]).max);
      const auto depth = depthOf(read);
      EXPECT_EQ(depth, depthOf(truth[k]));
      EXPECT_GT(std::count_if(depth.begin(), depth.end(), [](float z) { return z < 9; }), 2000);
    }
  }
}

}  // namespace
}  // namespace fourdvt::capture

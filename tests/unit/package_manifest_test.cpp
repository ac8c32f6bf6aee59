// SPDX-License-Identifier: Apache-2.0
// character.gltf: what the writer writes, the reader reads; every damaged field is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "package/writer.h"

using namespace fourdvt;
using namespace fourdvt::package;
using nlohmann::json;

namespace {

const std::string kAt = std::string("/extensions/") + kExtensionName;

FlatJson flatten(const json& value) {
  FlatJson flat;
  const json flattened = value.flatten();
  for (const auto& [pointer, leaf] : flattened.items()) {
    if (leaf.is_number()) flat.set(pointer, leaf.get<double>());
    if (leaf.is_string()) flat.set(pointer, leaf.get<std::string>());
    if (leaf.is_boolean()) flat.set(pointer, leaf.get<bool>());
  }
  return flat;
}

EncodedBaseMesh smallMesh() {
  MeshTopology t;
  t.vertex_count = 4;
  t.uvs = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  t.face_vertices = {{0, 2, 1}, {1, 2, 3}};
  t.face_uvs = t.face_vertices;
  return encodeBaseMesh(t, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5f}}).take();
}

Character smallCharacter(const EncodedBaseMesh& mesh) {
  Character c;
  c.name = "tiny";
  c.layer_count = 2;
  c.vertex_count = mesh.decoded.topology.vertex_count;
  c.face_count = mesh.decoded.topology.faceCount();
  for (int k = 0; k < 3; ++k) {
    OrbitView view;
    view.azimuth_deg = 37 * k;
    view.elevation_deg = 12;
    PinholeCamera camera = cameraFromOrbit(view, 720, 960);
    camera.name = "cam0" + std::to_string(k);
    camera.cx += 3.25;
    c.cameras.push_back(camera);
  }
  c.bounds = {{-1, 0, -1}, {1, 2.125f, 1}};
  c.mesh_uri = "mesh.bin";
  c.mesh_bytes = mesh.bytes.size();
  c.poster_uri = "poster.webp";
  Sequence s;
  s.name = "walk";
  s.frame_count = 28;
  s.fps = 25;
  s.loop = true;
  s.root_velocity_mps = {0, 0, 1.2265};
  s.stream_uri = "walk.bin";
  s.stream_bytes = 5000000000ull;  // above 32 bits
  s.stream_header_bytes = 900;
  s.renditions = {{"walk.mp4", 123456, "avc1.640028", 1536, 1056, {{0, 0, 1024, 1024}, {1024, 0, 512, 512}}, {}}};
  s.renditions[0].barcode.rect = {0, 1032, 512, 16};
  c.sequences = {s};
  return c;
}

json writtenManifest() {
  const EncodedBaseMesh mesh = smallMesh();
  auto text = writeManifest({smallCharacter(mesh), &mesh, "still.jpg", "fourdvt test", "nobody"});
  EXPECT_TRUE(text.ok());
  // For the Khronos validator: FOURDVT_SAMPLE_OUT names a folder.
  if (const char* folder = std::getenv("FOURDVT_SAMPLE_OUT")) {
    std::ofstream(std::string(folder) + "/character.gltf") << text.value();
    std::ofstream(std::string(folder) + "/mesh.bin", std::ios::binary)
        .write(reinterpret_cast<const char*>(mesh.bytes.data()), std::streamsize(mesh.bytes.size()));
  }
  return json::parse(text.value());
}

void expectRefused(const std::string& pointer, const json& value) {
  json damaged = writtenManifest();
  damaged[json::json_pointer(kAt + pointer)] = value;
  auto read = readManifest(flatten(damaged));
  ASSERT_FALSE(read.ok()) << pointer << " = " << value;
  EXPECT_EQ(read.error().id, ErrorId::ManifestInvalid) << pointer;
}

}  // namespace

TEST(Manifest, RoundTrips) {
  const EncodedBaseMesh mesh = smallMesh();
  const Character want = smallCharacter(mesh);
  auto read = readManifest(flatten(writtenManifest()));
  ASSERT_TRUE(read.ok()) << read.error().message;
  const Character& got = read.value();
  EXPECT_EQ(got.name, want.name);
  EXPECT_EQ(got.layer_count, 2);
  EXPECT_EQ(got.mesh_bytes, want.mesh_bytes);
  EXPECT_EQ(got.poster_uri, "poster.webp");
  EXPECT_EQ(got.bounds.max, want.bounds.max);
  ASSERT_EQ(got.cameras.size(), 3u);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(got.cameras[k].name, want.cameras[k].name);
    EXPECT_EQ(got.cameras[k].fx, want.cameras[k].fx);
    EXPECT_EQ(got.cameras[k].cx, want.cameras[k].cx);
    EXPECT_EQ(got.cameras[k].cam_from_world, want.cameras[k].cam_from_world);
  }
  ASSERT_EQ(got.sequences.size(), 1u);
  const Sequence& s = got.sequences[0];
  EXPECT_EQ(s.stream_bytes, 5000000000ull);
  EXPECT_TRUE(s.loop);
  EXPECT_EQ(s.root_velocity_mps, want.sequences[0].root_velocity_mps);
  EXPECT_EQ(s.renditions[0].codec, "avc1.640028");
  EXPECT_EQ(s.renditions[0].layers[1].x, 1024);
  EXPECT_EQ(s.renditions[0].barcode.rect.y, 1032);
  EXPECT_EQ(got.find("walk"), &s);
  EXPECT_EQ(got.find("run"), nullptr);
}

TEST(Manifest, CameraNodesLookWhereTheCamerasDo) {
  const json gltf = writtenManifest();
  const Character want = smallCharacter(smallMesh());
  ASSERT_EQ(gltf["cameras"].size(), 3u);
  for (int k = 0; k < 3; ++k) {
    const json& matrix = gltf["nodes"][2 + k]["matrix"];
    const glm::dvec3 forward = want.cameras[k].forwardInWorld(), centre = want.cameras[k].centreInWorld();
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(matrix[8 + i].get<double>(), -forward[i], 1e-9);  // +Z of a glTF camera looks back
      EXPECT_NEAR(matrix[12 + i].get<double>(), centre[i], 1e-9);
    }
    EXPECT_GT(matrix[5].get<double>(), 0.5);  // +Y is up
    EXPECT_NEAR(gltf["cameras"][k]["perspective"]["yfov"].get<double>(), 35 * 3.14159265358979 / 180, 1e-9);
  }
}

TEST(Manifest, RefusesDamagedFields) {
  for (const char* uri : {"../walk.bin", "/walk.bin", "https://x.org/walk.bin", "a/../../b", "", "a\\b", "data:,x"}) {
    expectRefused("/sequences/0/stream/uri", uri);
    expectRefused("/mesh/uri", uri);
    expectRefused("/sequences/0/renditions/0/uri", uri);
  }
  expectRefused("/layerCount", 0);
  expectRefused("/layerCount", 7);
  expectRefused("/layerCount", 1.5);
  expectRefused("/layerCount", 3);  // only two rectangles
  expectRefused("/vertexCount", 1e12);
  expectRefused("/faceCount", -1);
  expectRefused("/faceCount", "8000");
  expectRefused("/version", 0);
  expectRefused("/cameras", json::array());
  expectRefused("/cameras/1/fx", 0);
  expectRefused("/cameras/1/camFromWorld/0", 7);
  expectRefused("/sequences/0/fps", 0);
  expectRefused("/sequences/0/frameCount", 0);
  expectRefused("/sequences/0/stream/headerLength", 6000000000ull);
  expectRefused("/sequences/0/renditions", json::array());
  expectRefused("/sequences/0/renditions/0/width", 1535);
  expectRefused("/sequences/0/renditions/0/width", 100000);
  expectRefused("/sequences/0/renditions/0/layers/1/0", 1025);
  expectRefused("/sequences/0/renditions/0/layers/1/2", 256);
  expectRefused("/sequences/0/renditions/0/barcode/rect/1", 1050);
  expectRefused("/sequences/0/renditions/0/barcode/cellSize", 8);
  expectRefused("/bounds/min/0", 5);
  expectRefused("/bounds/min/0", nullptr);
}

TEST(Manifest, RefusesNonFiniteNumbersAndTooManyCameras) {
  FlatJson flat = flatten(writtenManifest());
  flat.set(kAt + "/groundY", std::nan(""));
  EXPECT_FALSE(readManifest(flat).ok());
  json many = writtenManifest();
  json& cameras = many[json::json_pointer(kAt + "/cameras")];
  while (cameras.size() < 32) cameras.push_back(cameras[0]);
  EXPECT_FALSE(readManifest(flatten(many)).ok());
  json twice = writtenManifest();
  json& sequences = twice[json::json_pointer(kAt + "/sequences")];
  sequences.push_back(sequences[0]);
  EXPECT_FALSE(readManifest(flatten(twice)).ok());
}

TEST(Manifest, EveryMissingFieldIsRefused) {
  const json whole = writtenManifest();
  const json fields = whole[json::json_pointer(kAt)].flatten();
  for (const auto& [pointer, value] : fields.items()) {
    FlatJson flat;
    const json all = whole.flatten();
    for (const auto& [key, leaf] : all.items()) {
      if (key == kAt + pointer) continue;
      if (leaf.is_number()) flat.set(key, leaf.get<double>());
      if (leaf.is_string()) flat.set(key, leaf.get<std::string>());
      if (leaf.is_boolean()) flat.set(key, leaf.get<bool>());
    }
    EXPECT_FALSE(readManifest(flat).ok()) << pointer;
  }
}

TEST(Manifest, NewerVersionIsUnsupported) {
  json newer = writtenManifest();
  newer[json::json_pointer(kAt + "/version")] = 2;
  auto read = readManifest(flatten(newer));
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().id, ErrorId::Unsupported);
  EXPECT_FALSE(readManifest(FlatJson()).ok());
}

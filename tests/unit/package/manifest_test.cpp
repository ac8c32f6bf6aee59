// SPDX-License-Identifier: Apache-2.0
// character.gltf: the reader restores what was written, and rejects every damaged field.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "manifest_fixture.h"
#include "package/writer.h"
#include "surface_fixture.h"

using namespace fourdvt;
using namespace fourdvt::package;
using fourdvt::testing::flatten;
using fourdvt::testing::kAt;
using fourdvt::testing::smallCharacter;
using fourdvt::testing::smallMesh;
using fourdvt::testing::surfaceCharacter;
using nlohmann::json;

namespace {

// Walk and run by speed, with one correction; tiles: walk's two layers, then run's.
Sequence locomotion(const Sequence& walk) {
  Sequence s = walk;
  s.name = "locomotion";
  s.members = {{"walk", {1.25}, 1.12, {0.125, 1.5, 0}}, {"run", {2.75}, 0.76, {0, 2, 0.0625}}};
  s.space = {{"speed_mps"},
             {{{1.25}, {1, 0}, {0}}, {{2}, {0.375f, 0.625f}, {1}}, {{2.75}, {0, 1}, {0}}},
             {{0, 1, 1}, {1, 2, 2}}};
  s.reference_count = 1;
  s.detail_correlation = 0.75f;
  s.renditions[0].layers = {{0, 0, 512, 512}, {512, 0, 256, 256}, {768, 0, 512, 512}, {1280, 0, 256, 256}};
  return s;
}

// Three motions over a triangle of two parameters, without corrections.
Sequence steering(const Sequence& walk) {
  Sequence s = walk;
  s.name = "steering";
  s.members = {{"walk", {1, 0}, 1, {0, 1, 0}}, {"run", {3, 0}, 0.75, {0, 2, 0}}, {"turn", {1, 90}, 1.5, {0.5, 0, 1.5}}};
  s.space = {{"speed_mps", "turn_dps"},
             {{{1, 0}, {1, 0, 0}, {}}, {{3, 0}, {0, 1, 0}, {}}, {{1, 90}, {0, 0, 1}, {}}},
             {{0, 1, 2}}};
  s.renditions[0].layers.assign(6, {0, 0, 512, 512});
  return s;
}

Room smallRoom() {
  Room room{{{-3, 0, -2.5f}, {3, 2.75f, 2.5f}}, "room.jpg", 98765, 0xfedcba9876543210, 640, 400, {}};
  for (int f = 0; f < 6; ++f) room.faces[size_t(f)] = {16 + 100 * f, 8, 90, 80 + f};
  return room;
}

json writtenManifest() {
  const EncodedBaseMesh mesh = smallMesh();
  Character character = smallCharacter(mesh);
  character.graph_uri = "graph.bin";
  character.graph_bytes = 4321;
  character.graph_hash = 0x0123456789abcdef;
  character.room = smallRoom();
  character.sequences.push_back(locomotion(character.sequences[0]));
  character.sequences.push_back(steering(character.sequences[0]));
  auto text = writeManifest({character, &mesh, "still.jpg", "fourdvt test", "nobody"});
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
  EXPECT_EQ(got.mesh_hash, want.mesh_hash);
  EXPECT_EQ(got.poster_uri, "poster.webp");
  EXPECT_EQ(got.bounds.max, want.bounds.max);
  ASSERT_EQ(got.cameras.size(), 3u);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(got.cameras[k].name, want.cameras[k].name);
    EXPECT_EQ(got.cameras[k].fx, want.cameras[k].fx);
    EXPECT_EQ(got.cameras[k].cx, want.cameras[k].cx);
    EXPECT_EQ(got.cameras[k].cam_from_world, want.cameras[k].cam_from_world);
  }
  ASSERT_EQ(got.sequences.size(), 3u);
  const Sequence& s = got.sequences[0];
  EXPECT_EQ(s.stream_bytes, 5000000000ull);
  EXPECT_EQ(s.stream_header_hash, 0x12u);
  EXPECT_TRUE(s.loop);
  EXPECT_EQ(s.root_velocity_mps, want.sequences[0].root_velocity_mps);
  EXPECT_EQ(s.renditions[0].codec, "avc1.640028");
  EXPECT_EQ(s.renditions[0].layers[1].x, 1024);
  EXPECT_EQ(s.renditions[0].barcode.rect.y, 1032);
  EXPECT_EQ(got.find("walk"), &s);
  EXPECT_EQ(got.find("run"), nullptr);
}

void expectSame(const Sequence& got, const Sequence& want) {
  ASSERT_EQ(got.members.size(), want.members.size());
  for (size_t m = 0; m < want.members.size(); ++m) {
    EXPECT_EQ(got.members[m].name, want.members[m].name);
    EXPECT_EQ(got.members[m].parameter, want.members[m].parameter);
    EXPECT_EQ(got.members[m].duration_s, want.members[m].duration_s);
    EXPECT_EQ(got.members[m].travel, want.members[m].travel);
  }
  EXPECT_EQ(got.reference_count, want.reference_count);
  EXPECT_EQ(got.detail_correlation, want.detail_correlation);
  EXPECT_EQ(got.space.names, want.space.names);
  EXPECT_EQ(got.space.simplices, want.space.simplices);
  ASSERT_EQ(got.space.samples.size(), want.space.samples.size());
  for (size_t i = 0; i < want.space.samples.size(); ++i) {
    EXPECT_EQ(got.space.samples[i].at, want.space.samples[i].at);
    EXPECT_EQ(got.space.samples[i].weights, want.space.samples[i].weights);
    EXPECT_EQ(got.space.samples[i].offsets, want.space.samples[i].offsets);
  }
}

TEST(Manifest, ClassesAndTheGraphRoundTrip) {
  auto read = readManifest(flatten(writtenManifest()));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read.value().graph_uri, "graph.bin");
  EXPECT_EQ(read.value().graph_bytes, 4321u);
  EXPECT_EQ(read.value().graph_hash, 0x0123456789abcdefu);
  const Sequence walk = smallCharacter(smallMesh()).sequences[0];
  ASSERT_EQ(read.value().sequences.size(), 3u);
  expectSame(read.value().sequences[0], walk);
  EXPECT_FALSE(read.value().sequences[0].isClass());
  EXPECT_TRUE(read.value().sequences[1].isClass());
  expectSame(read.value().sequences[1], locomotion(walk));
  expectSame(read.value().sequences[2], steering(walk));
  EXPECT_EQ(read.value().sequences[1].renditions[0].layers[2].x, 768);
}

// Earlier manifests have no room.
TEST(Manifest, TheRoomRoundTripsAndIsOptional) {
  auto read = readManifest(flatten(writtenManifest()));
  ASSERT_TRUE(read.ok()) << read.error().message;
  const Room &got = read.value().room, want = smallRoom();
  EXPECT_EQ(got.box.min, want.box.min);
  EXPECT_EQ(got.box.max, want.box.max);
  EXPECT_EQ(got.picture_uri, "room.jpg");
  EXPECT_EQ(got.picture_bytes, 98765u);
  EXPECT_EQ(got.picture_hash, want.picture_hash);
  EXPECT_EQ(got.width, 640);
  EXPECT_EQ(got.height, 400);
  EXPECT_EQ(got.faces[5].x, 516);
  EXPECT_EQ(got.faces[5].height, 85);
  const EncodedBaseMesh mesh = smallMesh();
  auto without = writeManifest({smallCharacter(mesh), &mesh, "still.jpg", "fourdvt test", "nobody"});
  ASSERT_TRUE(without.ok());
  EXPECT_EQ(without.value().find("room"), std::string::npos);
  read = readManifest(flatten(json::parse(without.value())));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_TRUE(read.value().room.picture_uri.empty());
}

TEST(Manifest, TheLengthScaleRoundTripsAndIsOptional) {
  const EncodedBaseMesh mesh = smallMesh();
  Character character = smallCharacter(mesh);
  const auto written = [&] {
    return json::parse(writeManifest({character, &mesh, "still.jpg", "fourdvt test", "nobody"}).take());
  };
  json gltf = written();
  EXPECT_FALSE(gltf.at(json::json_pointer(kAt)).contains("lengthScale")) << "a person's";
  EXPECT_EQ(readManifest(flatten(gltf)).take().length_scale, 1);
  character.length_scale = 1 / 16.0;
  gltf = written();
  EXPECT_EQ(readManifest(flatten(gltf)).take().length_scale, 1 / 16.0);
  for (const double wrong : {0.0, -1.0, 1e7}) {
    gltf[json::json_pointer(kAt + "/lengthScale")] = wrong;
    EXPECT_EQ(readManifest(flatten(gltf)).error().id, ErrorId::ManifestInvalid) << wrong;
  }
}

TEST(Manifest, ASequenceWithoutMembersIsItsOwn) {
  json old = writtenManifest();
  json& fields = old[json::json_pointer(kAt)];
  fields.erase("graph");
  fields["sequences"][0].erase("members");
  auto read = readManifest(flatten(old));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_TRUE(read.value().graph_uri.empty());
  const Sequence& s = read.value().sequences[0];
  ASSERT_EQ(s.members.size(), 1u);
  EXPECT_EQ(s.members[0].name, "walk");
  EXPECT_TRUE(s.members[0].parameter.empty());
  EXPECT_DOUBLE_EQ(s.members[0].duration_s, 28 / 25.0);
  EXPECT_DOUBLE_EQ(s.members[0].travel.y, 1.2265 * 28 / 25);
  EXPECT_EQ(s.members[0].travel.x, 0);
  EXPECT_EQ(s.members[0].travel.z, 0) << "no turning";
  EXPECT_TRUE(s.space.names.empty());
}

TEST(Manifest, RefusesClassesThatCannotBe) {
  const std::string one = "/sequences/1", two = "/sequences/2";
  expectRefused(one + "/members/0/parameter", json::array());
  expectRefused(one + "/members/0/parameter", {1, 2});
  expectRefused(one + "/members/0/duration", 0);
  expectRefused(one + "/members/1/name", "walk");
  expectRefused(one + "/members/1/travel", {0, 1e9, 0});
  expectRefused(one + "/referenceCount", 2);  // the samples hold one coefficient
  expectRefused(one + "/referenceCount", 0);
  expectRefused(one + "/referenceCount", 33);
  expectRefused(one + "/detailCorrelation", 1.5);
  expectRefused(one + "/detailCorrelation", -0.1);
  expectRefused(two + "/referenceCount", 1);
  expectRefused(one + "/parameterSpace/names", json::array());
  expectRefused(one + "/parameterSpace/names", {"speed_mps", "turn_dps"});
  expectRefused(two + "/parameterSpace/names", {"speed_mps", "speed_mps"});
  expectRefused(two + "/parameterSpace/names", {"a", "b", "c"});
  expectRefused(one + "/parameterSpace/samples", json::array());
  expectRefused(one + "/parameterSpace/samples/1/at", {2, 3});
  expectRefused(one + "/parameterSpace/samples/1/weights", {1});
  expectRefused(one + "/parameterSpace/samples/1/weights", {0.375, 0.62});
  expectRefused(one + "/parameterSpace/samples/1/weights", {-0.5, 1.5});
  expectRefused(one + "/parameterSpace/samples/1/offsets", json::array());
  expectRefused(one + "/parameterSpace/samples/1/offsets", {1e30});
  expectRefused(one + "/parameterSpace/samples/1/at", {1.25});  // an interval of no length
  expectRefused(one + "/parameterSpace/simplices", json::array());
  expectRefused(one + "/parameterSpace/simplices/1", {1, 2, 3});
  expectRefused(one + "/parameterSpace/simplices/1", {0, 1, 2});
  expectRefused(one + "/parameterSpace/simplices/1", {1, 1, 1});
  expectRefused(two + "/parameterSpace/simplices/0", {0, 1, 1});
  expectRefused(two + "/parameterSpace/samples/2/at", {5, 0});                          // on one line
  expectRefused(one + "/renditions/0/layers", {{0, 0, 512, 512}, {512, 0, 256, 256}});  // one member's only
  expectRefused("/graph/uri", "../graph.bin");
  expectRefused("/graph/byteLength", 0);
  expectRefused("/graph/hash", 0);
  json five = writtenManifest();
  json& members = five[json::json_pointer(kAt + one + "/members")];
  for (int m = 2; m < 5; ++m)
    members.push_back({{"name", "m" + std::to_string(m)}, {"parameter", {m}}, {"duration", 1}, {"travel", {0, 0, 0}}});
  EXPECT_FALSE(readManifest(flatten(five)).ok());
  FlatJson flat = flatten(writtenManifest());
  flat.set(kAt + one + "/parameterSpace/samples/1/weights/0", std::nan(""));
  EXPECT_FALSE(readManifest(flat).ok());
}

// Weights within rounding tolerance are clamped, so that the renderer accepts them.
TEST(Manifest, ClampsWeights) {
  json slack = writtenManifest();
  json& weights = slack[json::json_pointer(kAt + "/sequences/1/parameterSpace/samples/1/weights")];
  weights = {-0.001, 1.001};
  auto read = readManifest(flatten(slack));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read.value().sequences[1].space.samples[1].weights, (std::vector<float>{0, 1}));
  expectRefused("/sequences/1/parameterSpace/samples/1/weights", {-0.0011, 1.0011});
}

TEST(Manifest, CameraNodesLookWhereTheCamerasDo) {
  const json gltf = writtenManifest();
  const Character want = smallCharacter(smallMesh());
  ASSERT_EQ(gltf["cameras"].size(), 3u);
  for (int k = 0; k < 3; ++k) {
    const json& matrix = gltf["nodes"][2 + k]["matrix"];
    const glm::dvec3 forward = want.cameras[k].forwardInWorld(), centre = want.cameras[k].centreInWorld();
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(matrix[8 + i].get<double>(), -forward[i], 1e-9);  // a glTF camera's +Z points backwards
      EXPECT_NEAR(matrix[12 + i].get<double>(), centre[i], 1e-9);
    }
    EXPECT_GT(matrix[5].get<double>(), 0.5);  // +Y is up
    EXPECT_NEAR(gltf["cameras"][k]["perspective"]["yfov"].get<double>(), 35 * 3.14159265358979 / 180, 1e-9);
  }
}

TEST(Manifest, RefusesDamagedFields) {
  for (const char* uri : {"../walk.bin",
                          "/walk.bin",
                          "https://x.org/walk.bin",
                          "a/../../b",
                          "",
                          "a\\b",
                          "data:,x",
                          "%2e%2e/%2e%2e/x",
                          ".%2E/x",
                          " //other.example/x",
                          "\t//other.example/x",
                          "./walk.bin",
                          "a//b",
                          "a/.",
                          "a/",
                          "walk bin",
                          "w\u00e4lk.bin",
                          "walk.bin?x",
                          "walk.bin#x",
                          "~/x",
                          "a%2f..%2fb"}) {
    expectRefused("/sequences/0/stream/uri", uri);
    expectRefused("/mesh/uri", uri);
    expectRefused("/room/uri", uri);
    expectRefused("/sequences/0/renditions/0/uri", uri);
  }
  expectRefused("/layerCount", 0);
  expectRefused("/layerCount", 7);
  expectRefused("/layerCount", 1.5);
  expectRefused("/layerCount", 3);  // only two rectangles
  expectRefused("/vertexCount", 1e12);
  expectRefused("/faceCount", -1);
  expectRefused("/faceCount", "8000");
  for (const char* hash :
       {"0123456789abcde", "0123456789abcdef0", "0123456789abcdeg", "0x23456789abcdef", "0123456789ABCDEF"}) {
    expectRefused("/mesh/hash", hash);
    expectRefused("/sequences/0/stream/headerHash", hash);
  }
  expectRefused("/room/hash", "0123");
  expectRefused("/room/byteLength", 0);
  expectRefused("/room/byteLength", 17 << 20);
  expectRefused("/room/width", 4097);
  expectRefused("/room/height", 84);  // faces end at 93
  expectRefused("/room/faces/2/0", 600);
  expectRefused("/room/faces/2/2", 0);
  expectRefused("/room/faces/6", json::array({0, 0, 1, 1}));
  expectRefused("/room/min/1", 2.875);
  expectRefused("/room/max/2", "far");
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

TEST(Manifest, AcceptsPathsBelowTheFolder) {
  for (const char* uri : {"walk.bin", "parts/walk_2.bin", "a/b/c-d.E9.bin", "...", "a/..b", ".hidden"}) {
    json manifest = writtenManifest();
    manifest[json::json_pointer(kAt + "/sequences/0/stream/uri")] = uri;
    auto read = readManifest(flatten(manifest));
    EXPECT_TRUE(read.ok()) << uri;
  }
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
    if (value.is_null() || pointer.ends_with("/detailCorrelation")) continue;  // an empty list, an optional field
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

// Checks that the corpus is accepted, since a rejected one would test nothing.
TEST(FuzzCorpus, ManifestsAreAccepted) {
  for (const char* name : {"whole.txt", "classes.txt", "cameras.txt"}) {
    std::ifstream file(std::string(FOURDVT_SOURCE_DIR "/tests/fuzz/corpus/manifest_fuzz/") + name);
    FlatJson flat;
    flat.set("/asset/version", std::string("2.0"));
    for (std::string line; std::getline(file, line);) {
      const size_t equals = line.find('=');
      ASSERT_LT(equals + 1, line.size()) << line;
      const std::string pointer = kAt + line.substr(0, equals), value = line.substr(equals + 2);
      if (line[equals + 1] == 'n') flat.set(pointer, std::stod(value));
      if (line[equals + 1] == 's') flat.set(pointer, value);
      if (line[equals + 1] == 'b') flat.set(pointer, value == "T");
    }
    auto read = readManifest(flat);
    EXPECT_TRUE(read.ok()) << name << ": " << (read.ok() ? "" : read.error().message);
  }
}

Character cameraCharacter() {
  Character c = surfaceCharacter();
  c.vertex_count = 12345;
  c.face_count = 24686;
  c.mesh_uri = "mesh.bin";
  c.mesh_hash = 5;
  c.poster_uri = "poster.webp";
  Sequence& s = c.sequences[0];
  s.stream_uri = "turn.bin";
  s.stream_bytes = 5000;
  s.stream_header_bytes = 900;
  s.root_velocity_mps = {0, 0, 0.5};
  s.renditions = {{"turn.mp4", 4000, "avc1.640028", 64, 56, {}, {{0, 48, 64, 2}, 2}, {0, 0, 32, 24}}};
  return c;
}

json cameraManifest(bool coloured = false) {
  const QuantisedSurface surface = fourdvt::testing::roundSurface(12, 10, 0);
  TriangleMesh floats{{}, surface.faces};
  for (const glm::ivec3& q : surface.positions) floats.positions.push_back(0.001f * glm::vec3(q));
  const std::vector<glm::u16vec3> colours(coloured ? floats.positions.size() : 0, {65535, 300, 0});
  const EncodedBaseMesh mesh = encodePlainMesh(floats, colours).take();
  Character character = cameraCharacter();
  character.mesh_bytes = mesh.bytes.size();
  auto text = writeManifest({character, &mesh, "", "fourdvt test", "nobody"});
  EXPECT_TRUE(text.ok());
  if (const char* folder = std::getenv("FOURDVT_SAMPLE_OUT")) {
    std::ofstream(std::string(folder) + "/cameras.gltf") << text.value();
    std::ofstream(std::string(folder) + "/mesh.bin", std::ios::binary)
        .write(reinterpret_cast<const char*>(mesh.bytes.data()), std::streamsize(mesh.bytes.size()));
  }
  return json::parse(text.value());
}

TEST(CameraManifest, OtherViewersSeeTheColoursOfVertices) {
  const json gltf = cameraManifest(true), grey = cameraManifest();
  const json& primitive = gltf["meshes"][0]["primitives"][0];
  const json& colours = gltf["accessors"][primitive["attributes"]["COLOR_0"].get<size_t>()];
  EXPECT_EQ(colours["componentType"], 5123);
  EXPECT_EQ(colours["type"], "VEC3");
  EXPECT_EQ(colours["normalized"], true);
  EXPECT_EQ(colours["count"], gltf["accessors"][primitive["attributes"]["POSITION"].get<size_t>()]["count"]);
  EXPECT_TRUE(primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"].contains("COLOR_0"));
  EXPECT_FALSE(gltf["materials"][0]["pbrMetallicRoughness"].contains("baseColorFactor")) << "white, the default";
  EXPECT_FALSE(grey["meshes"][0]["primitives"][0]["attributes"].contains("COLOR_0"));
  EXPECT_EQ(grey["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][0], 0.5);
}

TEST(CameraManifest, RoundTrips) {
  const json gltf = cameraManifest();
  const json& fields = gltf[json::json_pointer(kAt)];
  EXPECT_EQ(fields["version"], 2);
  EXPECT_EQ(fields["appearance"], "cameras");
  EXPECT_FALSE(fields.contains("layerCount"));
  EXPECT_FALSE(fields["sequences"][0].contains("members"));
  EXPECT_FALSE(fields["sequences"][0]["renditions"][0].contains("layers"));
  EXPECT_FALSE(gltf.contains("textures"));
  EXPECT_FALSE(gltf["meshes"][0]["primitives"][0]["attributes"].contains("TEXCOORD_0"));
  auto read = readManifest(flatten(gltf));
  ASSERT_TRUE(read.ok()) << read.error().message;
  const Character& got = read.value();
  EXPECT_EQ(got.appearance, AppearanceKind::Cameras);
  EXPECT_EQ(got.version, 2);
  EXPECT_EQ(got.layer_count, 0);
  EXPECT_EQ(got.face_count, 24686u);
  const Sequence& s = got.sequences[0];
  EXPECT_EQ(s.layout_width, 64);
  EXPECT_EQ(s.layout_height, 48);
  EXPECT_TRUE(s.renditions[0].layers.empty());
  EXPECT_EQ(s.renditions[0].tiles.width, 32);
  EXPECT_EQ(s.renditions[0].tiles.height, 24);
  ASSERT_EQ(s.members.size(), 1u);
  EXPECT_DOUBLE_EQ(s.members[0].travel.y, 0.5 * 8 / 25);
}

TEST(CameraManifest, RefusesWhatCannotBe) {
  const auto refuse = [](const std::string& pointer, const json& value) {
    json damaged = cameraManifest();
    damaged[json::json_pointer(kAt + pointer)] = value;
    auto read = readManifest(flatten(damaged));
    ASSERT_FALSE(read.ok()) << pointer << " = " << value;
    EXPECT_EQ(read.error().id, ErrorId::ManifestInvalid) << pointer;
  };
  refuse("/appearance", "layers");
  refuse("/appearance", 1);
  refuse("/version", 1);  // without layers
  refuse("/graph", {{"uri", "graph.bin"}, {"byteLength", 4}, {"hash", "0123456789abcdef"}});
  refuse("/sequences/0/members", json::array({{{"name", "turn"}, {"duration", 1}, {"travel", {0, 0, 0}}}}));
  refuse("/sequences/0/layout", {64});
  refuse("/sequences/0/layout", {64, 48, 1});
  refuse("/sequences/0/layout/0", 0);
  refuse("/sequences/0/layout/1", 8193);
  refuse("/sequences/0/layout/1", 1.5);
  refuse("/sequences/0/renditions/0/tiles/0", 33);
  refuse("/sequences/0/renditions/0/tiles/3", 57);
  refuse("/sequences/0/renditions/0/tiles/2", 0);
  refuse("/sequences/0/renditions/0/tiles", json::array());
}

// Version 1 requires neither field.
TEST(CameraManifest, LayeredManifestsDoNotAskForItsFields) {
  json layered = writtenManifest();
  json& fields = layered[json::json_pointer(kAt)];
  EXPECT_EQ(fields["version"], 1);
  EXPECT_FALSE(fields.contains("appearance"));
  EXPECT_FALSE(fields["sequences"][0].contains("layout"));
  fields["appearance"] = "cameras";  // unknown to version 1
  auto read = readManifest(flatten(layered));
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read.value().appearance, AppearanceKind::Layers);
}

TEST(Manifest, CoarseGeometryIsOfVersion3) {
  json manifest = writtenManifest();
  const std::string stream = kAt + "/sequences/0/stream";
  manifest[json::json_pointer(stream + "/coarse/renditions")] = 1;
  manifest[json::json_pointer(stream + "/coarse/byteLength")] = 30;
  EXPECT_EQ(readManifest(flatten(manifest)).take().sequences[0].coarse_renditions, 0u) << "unknown in version 1";
  manifest[json::json_pointer(kAt + "/version")] = 3;
  Character c = readManifest(flatten(manifest)).take();
  EXPECT_EQ(c.sequences[0].coarse_renditions, 1u);
  EXPECT_EQ(c.sequences[0].coarse_bytes, 30u);
  EXPECT_EQ(c.sequences[0].geometryBytes(0), 30u + c.sequences[0].stream_header_bytes);
  EXPECT_EQ(c.sequences[0].geometryBytes(1), c.sequences[0].stream_bytes - 30);
  for (const auto& [field, value] : {std::pair{"renditions", 99.0}, {"renditions", 0.0}, {"byteLength", 1e12}}) {
    json bad = manifest;
    bad[json::json_pointer(stream + "/coarse/" + field)] = value;
    EXPECT_FALSE(readManifest(flatten(bad)).ok()) << field << " " << value;
  }
}

TEST(Manifest, NewerVersionIsUnsupported) {
  json newer = writtenManifest();
  newer[json::json_pointer(kAt + "/version")] = 4;
  auto read = readManifest(flatten(newer));
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().id, ErrorId::Unsupported);
  EXPECT_FALSE(readManifest(FlatJson()).ok());
}

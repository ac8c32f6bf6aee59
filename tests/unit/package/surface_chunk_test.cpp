// SPDX-License-Identifier: Apache-2.0
// Chunks of camera streams: round trips, one test for each limit of the reader, damage, and sizes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

#include "base/bytes.h"
#include "base/hash.h"
#include "draco/compression/expert_encode.h"
#include "package/base_mesh.h"
#include "package/base_mesh_draco.h"
#include "package/chunk_counts.h"
#include "package/surface_mesh.h"
#include "surface_fixture.h"

using namespace fourdvt;
using namespace fourdvt::package;
using namespace fourdvt::testing;

namespace {

struct Packed {
  Character character = surfaceCharacter();
  StreamIndex index;
  std::vector<uint8_t> bytes;
  uint32_t runs = 0;
  auto open() const { return SurfaceChunk::open(bytes, index, 0, character, character.sequences[0]); }
  bool decodes() const {
    auto chunk = open();
    return chunk.ok() && chunk.value()->decodeTo(UINT32_MAX).ok();
  }
};

Packed pack(const std::vector<QuantisedSurface>& frames) {
  Packed out;
  auto encoded = encodeSurfaceChunk(tilesOfAGop(0), frames);
  EXPECT_TRUE(encoded.ok()) << encoded.error().message;
  out.bytes = encoded.value().bytes;
  out.runs = encoded.value().run_count;
  out.index.frame_count = static_cast<uint32_t>(frames.size());
  out.index.vertex_count = encoded.value().vertex_count;
  out.index.face_count = encoded.value().face_count;
  out.index.position_origin = kSurfaceOrigin_m;
  out.index.position_step_m = kSurfaceStep_m;
  out.index.chunks = {{0, out.index.frame_count, 0, uint32_t(out.bytes.size())}};
  return out;
}

using Corners = std::array<glm::vec3, 3>;

// Triangles in an order that depends on their positions only.
std::vector<Corners> triangles(std::span<const glm::uvec3> faces, std::span<const glm::vec3> positions) {
  const auto less = [](const glm::vec3& a, const glm::vec3& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
  };
  std::vector<Corners> out;
  for (const glm::uvec3& f : faces) {
    Corners& c = out.emplace_back(Corners{positions[f.x], positions[f.y], positions[f.z]});
    std::rotate(c.begin(), std::min_element(c.begin(), c.end(), less), c.end());
  }
  std::sort(out.begin(), out.end(), [&](const Corners& a, const Corners& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), less);
  });
  return out;
}

std::vector<Corners> triangles(const QuantisedSurface& surface) {
  Positions positions;
  for (const glm::ivec3& q : surface.positions) positions.push_back(kSurfaceOrigin_m + kSurfaceStep_m * glm::vec3(q));
  return triangles(surface.faces, positions);
}

constexpr size_t kRunCount = 4 + 2 * 16, kRuns = kRunCount + 4;  // offsets in a chunk of two cameras

void put16(std::vector<uint8_t>& bytes, size_t at, uint32_t value) {
  bytes[at] = uint8_t(value), bytes[at + 1] = uint8_t(value >> 8);
}
void put32(std::vector<uint8_t>& bytes, size_t at, uint32_t value) {
  put16(bytes, at, value), put16(bytes, at + 2, value >> 16);
}
uint32_t get32(const std::vector<uint8_t>& bytes, size_t at) {
  uint32_t value = 0;
  std::memcpy(&value, &bytes[at], 4);
  return value;
}

void expectRefused(const Packed& packed, const char* what) {
  auto chunk = packed.open();
  if (!chunk) {
    EXPECT_EQ(chunk.error().id, ErrorId::StreamInvalid) << what;
    return;
  }
  const Status decoded = chunk.value()->decodeTo(UINT32_MAX);
  ASSERT_FALSE(decoded.ok()) << what;
  EXPECT_EQ(decoded.error().id, ErrorId::StreamInvalid) << what;
  EXPECT_FALSE(chunk.value()->decodeTo(0).ok()) << what << ": from then on always";
}

// Edgebreaker bytes of these positions, optionally with a second attribute.
std::vector<uint8_t> dracoBytes(const QuantisedSurface& surface, draco::DataType type, bool second) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<uint32_t>(surface.positions.size()));
  mesh.SetNumFaces(surface.faces.size());
  for (uint32_t f = 0; f < surface.faces.size(); ++f) {
    draco::Mesh::Face face;
    for (int c = 0; c < 3; ++c) face[c] = draco::PointIndex(surface.faces[f][c]);
    mesh.SetFace(draco::FaceIndex(f), face);
  }
  for (int a = 0; a <= int(second); ++a) {
    draco::GeometryAttribute attribute;
    attribute.Init(a ? draco::GeometryAttribute::GENERIC : draco::GeometryAttribute::POSITION, nullptr, 3, type, false,
                   12, 0);
    const int id = mesh.AddAttribute(attribute, true, mesh.num_points());
    for (uint32_t v = 0; v < mesh.num_points(); ++v)
      mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), &surface.positions[v]);
  }
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
  return {buffer.data(), buffer.data() + buffer.size()};
}

template <class Damage>
void refuse(const Packed& good, const char* what, Damage&& damage) {
  Packed bad = good;
  damage(bad);
  expectRefused(bad, what);
}

}  // namespace

TEST(SurfaceChunk, KeepsEverySurfaceExactly) {
  for (bool constant : {false, true}) {
    const auto frames = surfacesOfAGop(constant);
    const Packed packed = pack(frames);
    auto opened = packed.open();
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    SurfaceChunk& chunk = *opened.value();
    EXPECT_EQ(packed.runs, constant ? 1u : 4u);
    EXPECT_EQ(chunk.decodedCount(), 0u);
    ASSERT_TRUE(chunk.decodeTo(1).ok());
    EXPECT_EQ(chunk.decodedCount(), 2u);
    const glm::vec3* first = chunk.surface(0).positions.data();
    ASSERT_TRUE(chunk.decodeTo(UINT32_MAX).ok());
    EXPECT_EQ(chunk.decodedCount(), 4u);
    EXPECT_EQ(chunk.surface(0).positions.data(), first) << "surfaces stay where they are";
    uint64_t bytes = 0;
    for (uint32_t f = 0; f < 4; ++f) {
      const Surface surface = chunk.surface(f);
      EXPECT_EQ(surface.topology, constant ? 0 : f);
      EXPECT_EQ(triangles(surface.faces, surface.positions), triangles(frames[f])) << f;
      bytes += 12 * surface.positions.size() + (constant && f > 0 ? 0 : 12 * surface.faces.size());
    }
    EXPECT_GE(chunk.bytes(), bytes);
    EXPECT_LT(chunk.bytes(), bytes + 200);
  }
}

TEST(SurfaceChunk, SaysWhereTheTilesLie) {
  const Packed packed = pack(surfacesOfAGop(false));
  auto chunk = packed.open();
  ASSERT_TRUE(chunk.ok());
  const auto tiles = chunk.value()->tiles();
  ASSERT_EQ(tiles.size(), 2u);
  EXPECT_EQ(tiles[0].source.y, 20);
  EXPECT_EQ(tiles[0].source.height, 80);
  EXPECT_EQ(tiles[1].tile.x, 24);
  EXPECT_EQ(tiles[1].tile.width, 20);
  EXPECT_FALSE(tiles[1].empty());
  auto none = encodeSurfaceChunk(tilesOfAGop(1), surfacesOfAGop(false));
  auto second =
      SurfaceChunk::open(none.value().bytes, packed.index, 0, packed.character, packed.character.sequences[0]);
  ASSERT_TRUE(second.ok());
  EXPECT_TRUE(second.value()->tiles()[1].empty());
}

TEST(SurfaceChunk, AlternatesBetweenTopologies) {
  std::vector<QuantisedSurface> frames = surfacesOfAGop(true);
  for (const QuantisedSurface& other : surfacesOfAGop(false)) frames.push_back(other);
  for (const QuantisedSurface& again : surfacesOfAGop(true, 1)) frames.push_back(again);
  const Packed packed = pack(frames);
  EXPECT_EQ(packed.runs, 6u);
  auto chunk = packed.open();
  ASSERT_TRUE(chunk.ok() && chunk.value()->decodeTo(11).ok());
  for (uint32_t f = 0; f < 12; ++f) {
    const Surface s = chunk.value()->surface(f);
    EXPECT_EQ(triangles(s.faces, s.positions), triangles(frames[f])) << f;
    EXPECT_EQ(s.topology, f < 4 ? 0 : f < 8 ? f - 3 : 5);
  }
}

// A run with erratic vertices costs more as motion than as single meshes.
TEST(SurfaceChunk, ChoosesTheSmallerCoding) {
  std::mt19937 random(3);
  std::vector<QuantisedSurface> frames(3, roundSurface(30, 20, 0));
  const Packed still = pack(frames);
  EXPECT_EQ(still.runs, 1u);
  auto one = encodeSurfaceChunk(tilesOfAGop(0), std::span(frames).first(1));
  EXPECT_LT(still.bytes.size(), one.value().bytes.size() + 40) << "frames that do not move cost nothing";
  for (glm::ivec3& q : frames[1].positions)
    for (int k = 0; k < 3; ++k) q[k] = int(random() % 20000);
  frames[2] = roundSurface(30, 20, 5);
  const Packed wild = pack(frames);
  EXPECT_EQ(wild.runs, 3u);
}

TEST(SurfaceChunk, LeavesOutWhatIsNoSurfaceAndKeepsEdgesOfManyFaces) {
  QuantisedSurface surface = roundSurface(8, 6, 0);
  const auto want = triangles(surface);
  surface.faces.insert(surface.faces.begin(), {3, 3, 5});
  surface.positions.push_back({9, 9, 9});
  const Packed packed = pack({surface});
  auto chunk = packed.open();
  ASSERT_TRUE(chunk.ok() && chunk.value()->decodeTo(0).ok());
  EXPECT_EQ(triangles(chunk.value()->surface(0).faces, chunk.value()->surface(0).positions), want);
  // Two sheets along one edge, and one face twice.
  QuantisedSurface fan{{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {1, 0, 5}, {0, 1, 2}},
                       {{0, 0, 0}, {0, 9, 0}, {9, 0, 0}, {0, 0, 9}, {-9, 0, 0}, {0, 0, -9}}};
  const Packed many = pack({fan, fan});
  chunk = many.open();
  ASSERT_TRUE(chunk.ok() && chunk.value()->decodeTo(1).ok());
  for (uint32_t f = 0; f < 2; ++f)
    EXPECT_EQ(triangles(chunk.value()->surface(f).faces, chunk.value()->surface(f).positions), triangles(fan));
}

// Quantisation may merge two corners of a face.
TEST(SurfaceChunk, KeepsFacesThatHaveCollapsed) {
  for (uint32_t f = 0; f < 40; ++f) {
    QuantisedSurface surface = roundSurface(12, 10, 0);
    const glm::uvec3& face = surface.faces[5 * f];
    surface.positions[face.x] = surface.positions[face.y];
    EXPECT_TRUE(encodeSurfaceMesh(surface).ok()) << f;
  }
}

TEST(SurfaceChunk, RefusesToEncodeWhatCannotBeRead) {
  const auto refused = [](const QuantisedSurface& s) { return !encodeSurfaceChunk(tilesOfAGop(0), {&s, 1}).ok(); };
  const QuantisedSurface good = roundSurface(8, 6, 0);
  EXPECT_FALSE(refused(good));
  QuantisedSurface bad = good;
  bad.faces[3].y = uint32_t(bad.positions.size());
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.positions[7].z = (1 << 24) + 1;
  EXPECT_TRUE(refused(bad));
  bad.faces.clear();
  EXPECT_TRUE(refused(bad));
}

TEST(SurfaceChunk, RefusesEveryTruncationAndTrailingBytes) {
  for (bool constant : {false, true}) {
    Packed packed = pack(surfacesOfAGop(constant));
    const std::vector<uint8_t> whole = packed.bytes;
    for (size_t n = 0; n < whole.size(); n += n < 100 ? 1 : 13) {
      packed.bytes.assign(whole.begin(), whole.begin() + long(n));
      EXPECT_FALSE(packed.decodes()) << n;
    }
    packed.bytes = whole;
    packed.bytes.push_back(0);
    EXPECT_FALSE(packed.open().ok());
  }
}

TEST(SurfaceChunk, RefusesTilesThatCannotBe) {
  const Packed good = pack(surfacesOfAGop(false));
  refuse(good, "fewer cameras", [](Packed& p) { p.character.cameras.pop_back(); });
  refuse(good, "another camera count", [](Packed& p) { put32(p.bytes, 0, 3); });
  refuse(good, "source right of the picture", [](Packed& p) { put16(p.bytes, 4, 61); });
  refuse(good, "source below the picture", [](Packed& p) { put16(p.bytes, 6, 41); });
  refuse(good, "source without width", [](Packed& p) { put16(p.bytes, 8, 0); });
  refuse(good, "source without height", [](Packed& p) { put16(p.bytes, 10, 0); });
  refuse(good, "tile right of the layout", [](Packed& p) { put16(p.bytes, 12, 41); });
  refuse(good, "tile below the layout", [](Packed& p) { put16(p.bytes, 14, 1); });
  refuse(good, "tile without width", [](Packed& p) { put16(p.bytes, 16, 0); });
  refuse(good, "tile without height", [](Packed& p) { put16(p.bytes, 18, 0); });
  refuse(good, "a place without a size", [](Packed& p) {
    std::fill(p.bytes.begin() + 4, p.bytes.begin() + 20, 0);
    put16(p.bytes, 4, 1);
  });
}

TEST(SurfaceChunk, RefusesRunsThatCannotBe) {
  const Packed meshes = pack(surfacesOfAGop(false)), motion = pack(surfacesOfAGop(true));
  refuse(meshes, "no runs", [](Packed& p) { put32(p.bytes, kRunCount, 0); });
  refuse(meshes, "more runs than frames", [](Packed& p) { put32(p.bytes, kRunCount, 5); });
  refuse(meshes, "endless runs", [](Packed& p) { put32(p.bytes, kRunCount, UINT32_MAX); });
  refuse(meshes, "a run without frames", [](Packed& p) { put32(p.bytes, kRuns, 0); });
  refuse(meshes, "frames without motion", [](Packed& p) { put32(p.bytes, kRuns, 2); });
  refuse(motion, "motion of one frame", [](Packed& p) {
    put32(p.bytes, kRuns, 1);
    p.index.frame_count = p.index.chunks[0].frame_count = 1;
  });
  refuse(motion, "fewer frames than the GOP", [](Packed& p) { put32(p.bytes, kRuns, 3); });
  refuse(motion, "more frames than the GOP", [](Packed& p) { put32(p.bytes, kRuns, 5); });
  refuse(motion, "endless frames", [](Packed& p) { put32(p.bytes, kRuns, UINT32_MAX); });
  refuse(motion, "motion that is too short", [](Packed& p) {
    put32(p.bytes, kRuns + 8, get32(p.bytes, kRuns + 8) - 1);
    p.bytes.pop_back();
  });
  refuse(motion, "motion that is too long", [](Packed& p) {
    put32(p.bytes, kRuns + 8, get32(p.bytes, kRuns + 8) + 1);
    p.bytes.push_back(0);
  });
  refuse(meshes, "a last run that is missing", [](Packed& p) {
    p.bytes.resize(p.bytes.size() - get32(p.bytes, kRuns + 3 * 12 + 4));
    p.bytes.erase(p.bytes.begin() + kRuns + 3 * 12, p.bytes.begin() + kRuns + 4 * 12);
    put32(p.bytes, kRunCount, 3);
  });
  refuse(motion, "a run of no frames that has a mesh and a motion", [](Packed& p) {
    const std::vector<uint8_t> run(p.bytes.begin() + kRuns, p.bytes.begin() + kRuns + 12),
        parts(p.bytes.begin() + kRuns + 12, p.bytes.end());
    p.bytes.insert(p.bytes.begin() + kRuns, run.begin(), run.end());
    p.bytes.insert(p.bytes.end(), parts.begin(), parts.end());
    put32(p.bytes, kRunCount, 2);
    put32(p.bytes, kRuns, 0);
  });
  refuse(motion, "no such GOP", [](Packed& p) { p.index.chunks.clear(); });
}

TEST(SurfaceChunk, RefusesMoreThanTheHeaderSays) {
  for (bool constant : {false, true}) {
    const Packed good = pack(surfacesOfAGop(constant));
    refuse(good, "vertices", [](Packed& p) { --p.index.vertex_count; });
    refuse(good, "faces", [](Packed& p) { --p.index.face_count; });
    refuse(good, "infinite positions", [](Packed& p) { p.index.position_step_m = 1e38f; });
    refuse(good, "a stream of layers", [](Packed& p) { p.index.layer_count = 1; });
    refuse(good, "a character from layers", [](Packed& p) { p.character.appearance = AppearanceKind::Layers; });
  }
}

TEST(SurfaceMesh, RefusesOtherDracoMeshes) {
  const QuantisedSurface surface = roundSurface(12, 10, 0);
  auto encoded = encodeSurfaceMesh(surface);
  ASSERT_TRUE(encoded.ok());
  EXPECT_TRUE(decodeSurfaceMesh(encoded.value().bytes, 1000, 1000).has_value());
  EXPECT_FALSE(decodeSurfaceMesh(encoded.value().bytes, uint32_t(surface.positions.size()) - 1, 1000).has_value());
  EXPECT_FALSE(decodeSurfaceMesh(encoded.value().bytes, 1000, uint32_t(surface.faces.size()) - 1).has_value());
  // Positions as floats, and a base mesh, which has UVs as well.
  TriangleMesh floats{{}, surface.faces};
  for (const glm::ivec3& q : surface.positions) floats.positions.push_back(0.001f * glm::vec3(q));
  auto plain = encodePlainMesh(floats);
  ASSERT_TRUE(plain.ok());
  EXPECT_EQ(plain.value().uv_attribute, -1);
  EXPECT_FALSE(decodeSurfaceMesh(plain.value().bytes, 1000, 1000).has_value());
  MeshTopology t;
  t.vertex_count = 3;
  t.uvs = {{0, 0}, {1, 0}, {0, 1}};
  t.face_vertices = t.face_uvs = {{0, 1, 2}};
  auto base = encodeBaseMesh(t, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_FALSE(decodeSurfaceMesh(base.value().bytes, 1000, 1000).has_value());
  EXPECT_TRUE(decodeSurfaceMesh(dracoBytes(surface, draco::DT_INT32, false), 1000, 1000).has_value());
  EXPECT_FALSE(decodeSurfaceMesh(dracoBytes(surface, draco::DT_UINT32, false), 1000, 1000).has_value());
  EXPECT_FALSE(decodeSurfaceMesh(dracoBytes(surface, draco::DT_INT32, true), 1000, 1000).has_value());
  // A position outside the coder's range.
  QuantisedSurface far = surface;
  far.positions[5].x = (1 << 24) + 1;
  auto out = encodeSurfaceMesh(far);
  EXPECT_FALSE(out.ok()) << "its own decoder refuses it";
}

TEST(SurfaceChunk, SurvivesDamage) {
  for (bool constant : {false, true}) {
    const Packed good = pack(surfacesOfAGop(constant));
    std::mt19937 random(7);
    for (int i = 0; i < 200; ++i) {
      Packed bad = good;
      for (uint32_t edits = 1 + random() % 3; edits > 0; --edits)
        bad.bytes[random() % bad.bytes.size()] ^= uint8_t(1u << random() % 8);
      (void)bad.decodes();
    }
  }
}

TEST(SurfaceMesh, PlainMeshesCarryColoursOfTheirVertices) {
  const QuantisedSurface surface = roundSurface(12, 10, 0);
  TriangleMesh floats{{}, surface.faces};
  std::vector<glm::u16vec3> colours;
  for (const glm::ivec3& q : surface.positions) {
    floats.positions.push_back(0.001f * glm::vec3(q));
    colours.emplace_back(static_cast<uint16_t>(q.x + 4096), static_cast<uint16_t>(q.y + 4096), 65535);
  }
  const auto plain = encodePlainMesh(floats, colours, 20);
  ASSERT_TRUE(plain.ok());
  ASSERT_GE(plain.value().colour_attribute, 0);
  const auto decoded = decodeDracoMesh(plain.value().bytes);
  const auto* values = decoded->GetAttributeByUniqueId(uint32_t(plain.value().colour_attribute));
  ASSERT_TRUE(values);
  EXPECT_TRUE(values->normalized());
  const auto* positions = decoded->GetNamedAttribute(draco::GeometryAttribute::POSITION);
  for (uint32_t p = 0; p < decoded->num_points(); ++p) {
    glm::u16vec3 colour;
    glm::vec3 position;
    values->GetMappedValue(draco::PointIndex(p), &colour);
    positions->GetMappedValue(draco::PointIndex(p), &position);
    EXPECT_NEAR(colour.x, 1000 * position.x + 4096, 1) << "vertex " << p;
    EXPECT_NEAR(colour.y, 1000 * position.y + 4096, 1) << "vertex " << p;
    EXPECT_EQ(colour.z, 65535);
  }
  colours.pop_back();
  EXPECT_FALSE(encodePlainMesh(floats, colours).ok());
}

// Integers cost as much as Draco's own quantised floats: it predicts both by the same parallelograms.
TEST(SurfaceMesh, IntegersCostWhatQuantisedFloatsDo) {
  const QuantisedSurface surface = roundSurface(120, 60, 0);
  auto integers = encodeSurfaceMesh(surface);
  TriangleMesh floats{{}, surface.faces};
  glm::ivec3 low = surface.positions[0], high = low;
  for (const glm::ivec3& q : surface.positions) {
    floats.positions.push_back(kSurfaceStep_m * glm::vec3(q));
    low = glm::min(low, q), high = glm::max(high, q);
  }
  const glm::ivec3 size = high - low;
  const int bits = int(std::ceil(std::log2(std::max({size.x, size.y, size.z}) + 1)));
  auto quantised = encodePlainMesh(floats, {}, bits);
  ASSERT_TRUE(integers.ok() && quantised.ok());
  EXPECT_LT(integers.value().bytes.size(), 1.1 * quantised.value().bytes.size());
}

// Decodes chunks of stream version 8, forever: a change of layout or prediction needs a new version.
// FOURDVT_CORPUS_OUT: writes them, for a new version.
TEST(FuzzCorpus, SurfacesDecodeToWhatTheyAlwaysDid) {
  struct Frozen {
    const char* name;
    bool constant;
    uint64_t hash;  // of all faces and positions
  };
  for (const Frozen& frozen :
       {Frozen{"topologies.bin", false, 17871866160256825125u}, Frozen{"motion.bin", true, 13517761119389515585u}}) {
    Packed packed = pack(surfacesOfAGop(frozen.constant));
    if (const char* folder = std::getenv("FOURDVT_CORPUS_OUT")) {
      std::ofstream out(std::string(folder) + "/" + frozen.name, std::ios::binary);
      out.put(3);
      out.write(reinterpret_cast<const char*>(packed.bytes.data()), std::streamsize(packed.bytes.size()));
    }
    std::ifstream file(std::string(FOURDVT_SOURCE_DIR "/tests/fuzz/corpus/surface_fuzz/") + frozen.name,
                       std::ios::binary);
    const std::vector<uint8_t> bytes((std::istreambuf_iterator<char>(file)), {});
    ASSERT_GT(bytes.size(), 100u) << frozen.name;
    ASSERT_EQ(bytes[0], 3);  // frames of the GOP - 1
    packed.bytes.assign(bytes.begin() + 1, bytes.end());
    auto chunk = packed.open();
    ASSERT_TRUE(chunk.ok() && chunk.value()->decodeTo(3).ok()) << frozen.name;
    uint64_t hash = kFnv1aStart;
    for (uint32_t f = 0; f < 4; ++f) {
      const Surface s = chunk.value()->surface(f);
      hash = fnv1a({reinterpret_cast<const uint8_t*>(s.faces.data()), s.faces.size_bytes()}, hash);
      hash = fnv1a({reinterpret_cast<const uint8_t*>(s.positions.data()), s.positions.size_bytes()}, hash);
    }
    EXPECT_EQ(hash, frozen.hash) << frozen.name;
  }
}

TEST(CameraStream, HeaderHasItsOwnVersion) {
  Packed packed = pack(surfacesOfAGop(false));
  SampleTable table;
  table.samples = {{0, 9, 0, true}, {9, 9, 1, false}, {18, 9, 2, false}, {27, 9, 3, false}};
  table.chunk_first_sample = {0, 4};
  table.chunk_hash = {1};
  packed.index.renditions = {table};
  packed.index.chunks[0].offset = 1000;
  std::vector<uint8_t> bytes = writeStreamHeader(packed.index);
  EXPECT_EQ(bytes[4], 8);
  auto read = readStreamHeader(bytes);
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read.value().layer_count, 0u);
  EXPECT_EQ(read.value().face_count, packed.index.face_count);
  const auto refused = [](const StreamIndex& index) {
    auto again = readStreamHeader(writeStreamHeader(index));
    return !again.ok() && again.error().id == ErrorId::StreamInvalid;
  };
  EXPECT_FALSE(refused(packed.index));
  StreamIndex bad = packed.index;
  bad.member_count = 2;
  EXPECT_TRUE(refused(bad));
  bad.alignment_count = 1, bad.alignment_step_m = 1;
  EXPECT_TRUE(refused(bad));
  bad = packed.index, bad.reference_count = 1;
  EXPECT_TRUE(refused(bad));
  bytes[4] = 7;
  EXPECT_EQ(readStreamHeader(bytes).error().id, ErrorId::StreamInvalid) << "a layered stream without layers";
  bad = packed.index, bad.layer_count = 1;
  bytes = writeStreamHeader(bad);
  EXPECT_EQ(bytes[4], 7);
  bytes[4] = 8;
  EXPECT_EQ(readStreamHeader(bytes).error().id, ErrorId::StreamInvalid) << "a camera stream with layers";
  // Four frames, which may have a topology each.
  bad = packed.index, bad.vertex_count = 1u << 22;
  bad.face_count = uint32_t(kMaxDecodedChunkBytes / (4 * 12)) - bad.vertex_count;
  EXPECT_FALSE(refused(bad));
  ++bad.face_count;
  EXPECT_TRUE(refused(bad));
  EXPECT_EQ(decodedFrameBytes(packed.index), 12u * (packed.index.vertex_count + packed.index.face_count));
}

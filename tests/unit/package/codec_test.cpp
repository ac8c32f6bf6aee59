// SPDX-License-Identifier: Apache-2.0
// Round trips, truncation and damage of the stream header, GOP chunks, the base mesh and the barcode.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>

#include "chunk_fixture.h"
#include "package/barcode.h"
#include "package/base_mesh.h"
#include "package/character.h"
#include "package/chunk_counts.h"
#include "package/stream_file.h"

using namespace fourdvt;
using namespace fourdvt::package;
using fourdvt::testing::cylinder;
using fourdvt::testing::fillWithZeros;
using fourdvt::testing::indexFor;
using fourdvt::testing::sameChunk;
using fourdvt::testing::strandMesh;

namespace {

StreamIndex smallIndex() {
  StreamIndex index;
  index.frame_count = 5;
  index.vertex_count = 12;
  index.face_count = 7;
  index.layer_count = 2;
  index.member_count = 3;
  index.reference_count = 4;
  index.alignment_count = 2;
  index.position_origin = {0.5f, -1, 2};
  index.position_step_m = 0.00025f;
  index.alignment_step_m = 0.0005f;
  index.chunks = {{0, 3, 600, 40, 11}, {3, 2, 640, 30, 0xfedcba9876543210}};
  SampleTable table;
  table.decoder_description = {1, 2, 3};
  table.samples = {{100, 50, 0, true}, {150, 9, 2, false}, {159, 4, 1, false}, {400, 60, 3, true}, {460, 7, 4, false}};
  table.chunk_first_sample = {0, 3, 5};
  table.chunk_hash = {0x0123456789abcdef, 17};
  index.renditions = {table, table};
  return index;
}

struct Kind {
  uint32_t members = 1, references = 0;
  bool aligned = false;
};

ChunkFrames randomFrames(uint32_t frames, uint32_t vertices, uint32_t faces, uint32_t layers, uint32_t seed,
                         const Kind& kind = {}) {
  std::mt19937 random(seed);
  ChunkFrames out{frames, vertices, faces, layers, kind.members, kind.references, kind.aligned * (kind.members - 1), {},
                  {},     {},       {},    {}};
  fillWithZeros(out);
  for (glm::ivec3& q : out.positions) q = {int(random() % 20001) - 10000, int(random() % 7), -int(random() % 100000)};
  for (uint8_t& label : out.labels) {
    const uint32_t r = random() % 9;
    label = r == 8 ? kNoCamera : static_cast<uint8_t>(r);
  }
  for (glm::ivec3& q : out.offsets) q = {int(random() % 21) - 10, 0, int(random() % 2001) - 1000};
  for (glm::ivec2& q : out.alignment) q = {int(random() % 3) - 1, int(random() % 20001) - 10000};
  for (glm::vec3& r : out.root) r = {random() % 1000 * 0.001f, -1.5f, random() % 1000 * 0.01f};
  return out;
}

// FNV-1a over all integers of a chunk.
uint32_t checksum(const ChunkFrames& c) {
  uint32_t sum = 2166136261u;
  const auto add = [&](int32_t value) { sum = (sum ^ uint32_t(value)) * 16777619u; };
  for (const glm::ivec3& q : c.positions) add(q.x), add(q.y), add(q.z);
  for (uint8_t label : c.labels) add(label);
  for (const glm::ivec3& q : c.offsets) add(q.x), add(q.y), add(q.z);
  for (const glm::ivec2& q : c.alignment) add(q.x), add(q.y);
  return sum;
}

// A closed UV-mapped grid folded over the x axis: vertices with two wedge UVs along the seam.
void makeGrid(int n, MeshTopology& t, Positions& positions) {
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      positions.emplace_back(i * 0.1f, std::sin(i * 0.3f) * 0.2f, j * 0.1f);
      t.uvs.emplace_back(float(i) / n * 0.45f, float(j) / n);
    }
  }
  const uint32_t shift = static_cast<uint32_t>(t.uvs.size());
  for (uint32_t k = 0; k < shift; ++k) t.uvs.push_back(t.uvs[k] + glm::vec2(0.5f, 0));
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      const uint32_t chart = i < n / 2 ? 0 : shift;
      for (const glm::uvec3& f : {glm::uvec3(a, c, b), glm::uvec3(b, c, d)}) {
        t.face_vertices.push_back(f);
        t.face_uvs.push_back(f + chart);
      }
    }
  }
  t.vertex_count = static_cast<uint32_t>(positions.size());
}

}  // namespace

TEST(StreamHeader, RoundTrips) {
  const StreamIndex index = smallIndex();
  auto read = readStreamHeader(writeStreamHeader(index));
  ASSERT_TRUE(read.ok()) << read.error().message;
  const StreamIndex& r = read.value();
  EXPECT_EQ(r.frame_count, 5u);
  EXPECT_EQ(r.layer_count, 2u);
  EXPECT_EQ(r.member_count, 3u);
  EXPECT_EQ(r.reference_count, 4u);
  EXPECT_EQ(r.alignment_count, 2u);
  EXPECT_EQ(r.position_origin, index.position_origin);
  EXPECT_EQ(r.position_step_m, index.position_step_m);
  EXPECT_EQ(r.alignment_step_m, index.alignment_step_m);
  ASSERT_EQ(r.renditions.size(), 2u);
  EXPECT_EQ(r.renditions[1].decoder_description, index.renditions[1].decoder_description);
  EXPECT_EQ(r.renditions[1].chunk_first_sample, index.renditions[1].chunk_first_sample);
  EXPECT_EQ(r.renditions[1].chunk_hash, index.renditions[1].chunk_hash);
  EXPECT_EQ(r.chunks[1].hash, 0xfedcba9876543210);
  EXPECT_EQ(r.renditions[0].videoOf(1).offset, 400u);
  EXPECT_EQ(r.renditions[0].videoOf(1).bytes, 67u);
  for (size_t s = 0; s < 5; ++s) {
    EXPECT_EQ(r.renditions[0].samples[s].offset, index.renditions[0].samples[s].offset);
    EXPECT_EQ(r.renditions[0].samples[s].frame, index.renditions[0].samples[s].frame);
    EXPECT_EQ(r.renditions[0].samples[s].key, index.renditions[0].samples[s].key);
  }
  EXPECT_EQ(r.chunkOfFrame(2), 0u);
  EXPECT_EQ(r.chunkOfFrame(3), 1u);
}

TEST(StreamHeader, RefusesEveryTruncationAndTrailingBytes) {
  std::vector<uint8_t> bytes = writeStreamHeader(smallIndex());
  for (size_t n = 0; n < bytes.size(); ++n) {
    EXPECT_FALSE(readStreamHeader(std::span(bytes).first(n)).ok()) << n;
  }
  bytes.push_back(0);
  EXPECT_FALSE(readStreamHeader(bytes).ok());
}

TEST(StreamHeader, RefusesBadCounts) {
  const auto refuse = [](const StreamIndex& index) {
    auto read = readStreamHeader(writeStreamHeader(index));
    EXPECT_FALSE(read.ok());
    if (!read.ok()) {
      EXPECT_EQ(read.error().id, ErrorId::StreamInvalid);
    }
  };
  StreamIndex index = smallIndex();
  index.frame_count = 6;
  refuse(index);
  index = smallIndex();
  index.renditions[0].samples[3].key = false;
  refuse(index);
  index = smallIndex();
  index.renditions[0].samples[1].frame = 1;  // frame 1 twice, frame 2 never
  refuse(index);
  index = smallIndex();
  for (const float step : {NAN, INFINITY, 1e30f, -1.0f}) {  // 1e30 · q would be infinite
    index.position_step_m = step;
    refuse(index);
  }
  index = smallIndex();
  index.position_origin.z = -1e7f;
  refuse(index);
  index = smallIndex();
  index.chunks[0].offset = 3;  // inside the header
  refuse(index);
}

TEST(StreamHeader, RefusesMembersReferencesAndAlignmentThatCannotBe) {
  const auto refuse = [](auto&& damage) {
    StreamIndex index = smallIndex();
    damage(index);
    auto read = readStreamHeader(writeStreamHeader(index));
    ASSERT_FALSE(read.ok());
    EXPECT_EQ(read.error().id, ErrorId::StreamInvalid);
  };
  refuse([](StreamIndex& i) { i.member_count = 0; });
  refuse([](StreamIndex& i) { i.member_count = kMaxMembers + 1, i.alignment_count = kMaxMembers; });
  refuse([](StreamIndex& i) { i.reference_count = kMaxReferences + 1; });
  refuse([](StreamIndex& i) { i.alignment_count = 1; });  // of 3 members: 0 or 2
  refuse([](StreamIndex& i) { i.alignment_count = 3; });
  refuse([](StreamIndex& i) { i.member_count = 1, i.alignment_count = 0; });  // references, but one motion
  refuse([](StreamIndex& i) { i.member_count = 1, i.reference_count = 0; });  // alignment of one member
  refuse([](StreamIndex& i) { i.alignment_step_m = 0; });
  refuse([](StreamIndex& i) { i.alignment_step_m = INFINITY; });
  StreamIndex plain = smallIndex();
  plain.member_count = 1, plain.reference_count = plain.alignment_count = 0, plain.alignment_step_m = 0;
  EXPECT_TRUE(readStreamHeader(writeStreamHeader(plain)).ok());
}

TEST(StreamHeader, RefusesGopsThatTakeTooMuchMemory) {
  const auto read = [](const StreamIndex& index) { return readStreamHeader(writeStreamHeader(index)); };
  StreamIndex index = smallIndex();
  index.chunks[1].bytes = kMaxChunkBytes;
  EXPECT_TRUE(read(index).ok());
  ++index.chunks[1].bytes;
  EXPECT_EQ(read(index).error().id, ErrorId::StreamInvalid);
  index = smallIndex();
  // The second GOP's two samples follow each other.
  for (SampleTable& table : index.renditions) {
    table.samples[4].offset = table.samples[3].offset + (kMaxGopVideoBytes - 10);
    table.samples[3].bytes = kMaxGopVideoBytes - 10, table.samples[4].bytes = 10;
  }
  EXPECT_TRUE(read(index).ok());
  ++index.renditions[1].samples[4].bytes;
  EXPECT_EQ(read(index).error().id, ErrorId::StreamInvalid) << "of any rendition";
  // Few bytes, but a great deal of geometry: 3 members, 4 corrections and 2 alignment fields of 3 frames.
  index = smallIndex();
  const uint64_t vertex_bytes = 3 * (3 * 12 + 4 * 12 + 2 * 8);
  index.vertex_count = uint32_t(kMaxDecodedChunkBytes / vertex_bytes) - 1;
  EXPECT_TRUE(read(index).ok());
  index.vertex_count += 2;
  EXPECT_EQ(read(index).error().id, ErrorId::StreamInvalid);
}

TEST(ChunkFrames, SayWhatTheyTakeInMemory) {
  const ChunkFrames frames = randomFrames(3, 20, 30, 2, 1, {3, 4, true});
  StreamIndex index;
  copyCounts(frames, index);
  EXPECT_EQ(frames.bytes(), 3 * decodedFrameBytes(index));
}

TEST(StreamHeader, SurvivesEveryByteFlip) {
  const std::vector<uint8_t> bytes = writeStreamHeader(smallIndex());
  for (size_t n = 0; n < bytes.size(); ++n) {
    for (uint8_t mask : {0x01, 0x80, 0xff}) {
      std::vector<uint8_t> damaged = bytes;
      damaged[n] ^= mask;
      (void)readStreamHeader(damaged);
    }
  }
}

TEST(StreamHeader, AsksForANewBakeOfOlderVersionsAndANewPlayerForLater) {
  std::vector<uint8_t> bytes = writeStreamHeader(smallIndex());
  ASSERT_EQ(bytes[4], 7);
  for (uint8_t version : {1, 4, 5, 6}) {
    bytes[4] = version;
    auto old = readStreamHeader(bytes);
    ASSERT_FALSE(old.ok());
    EXPECT_EQ(old.error().id, ErrorId::Unsupported);
    EXPECT_NE(old.error().message.find("bake the character again"), std::string::npos);
  }
  bytes[4] = 10;
  auto later = readStreamHeader(bytes);
  ASSERT_FALSE(later.ok());
  EXPECT_EQ(later.error().id, ErrorId::Unsupported);
  EXPECT_NE(later.error().message.find("update the player"), std::string::npos);
}

TEST(StreamHeader, CoarseChunksAreOfTheSameGops) {
  StreamIndex in = smallIndex();
  in.coarse_chunks = in.chunks;
  for (ChunkEntry& chunk : in.coarse_chunks) chunk.offset += 1'000'000, chunk.bytes = 77, chunk.hash ^= 5;
  const std::vector<uint8_t> bytes = writeStreamHeader(in);
  ASSERT_EQ(bytes[4], 9);
  const StreamIndex out = readStreamHeader(bytes).take();
  ASSERT_EQ(out.coarse_chunks.size(), in.chunks.size());
  const StreamIndex coarse = out.coarse();
  for (size_t c = 0; c < in.chunks.size(); ++c) {
    EXPECT_EQ(coarse.chunks[c].first_frame, in.chunks[c].first_frame);
    EXPECT_EQ(coarse.chunks[c].frame_count, in.chunks[c].frame_count);
    EXPECT_EQ(coarse.chunks[c].offset, in.coarse_chunks[c].offset);
    EXPECT_EQ(coarse.chunks[c].bytes, 77u);
    EXPECT_EQ(coarse.chunks[c].hash, in.coarse_chunks[c].hash);
  }
  for (const auto damage : {1, 2}) {
    StreamIndex bad = in;
    if (damage == 1) bad.coarse_chunks[0].bytes = 0;
    if (damage == 2) bad.coarse_chunks[0].offset = 3;
    EXPECT_FALSE(readStreamHeader(writeStreamHeader(bad)).ok()) << damage;
  }
}

TEST(Chunk, RoundTripsExactly) {
  for (const Kind& kind : {Kind{1, 0, false}, {2, 0, false}, {2, 1, true}, {3, 5, true}, {4, 32, false}}) {
    for (uint32_t frames : {1u, 2u, 3u, 9u}) {
      const ChunkFrames in = randomFrames(frames, 40, 60, 3, frames, kind);
      const ChunkMesh mesh = strandMesh(40, 60);
      auto bytes = encodeChunk(in, mesh);
      ASSERT_TRUE(bytes.ok());
      auto out = decodeChunk(bytes.value(), indexFor(in), 0, mesh);
      ASSERT_TRUE(out.ok()) << out.error().message;
      EXPECT_TRUE(sameChunk(out.value(), in)) << kind.members << " members, " << frames << " frames";
      EXPECT_EQ(out.value().member_count, kind.members);
      EXPECT_EQ(encodeChunk(in, mesh).take(), bytes.value()) << "the same input, the same bytes";
    }
  }
}

// Parts are coded independently: another part's content does not change their bytes.
TEST(Chunk, OpensWithTheLengthsOfItsParts) {
  const ChunkFrames in = randomFrames(3, 20, 30, 3, 1, {2, 2, true});
  const ChunkMesh mesh = strandMesh(20, 30);
  const auto parts = [&](const ChunkFrames& frames) {
    const std::vector<uint8_t> bytes = encodeChunk(frames, mesh).take();
    std::vector<std::vector<uint8_t>> out;
    size_t at = 7 * 4;
    for (size_t p = 0; p < 7; ++p) {
      uint32_t length = 0;
      std::memcpy(&length, &bytes[p * 4], 4);
      out.emplace_back(bytes.begin() + at, bytes.begin() + at + length);
      at += length;
    }
    EXPECT_EQ(at + 3 * 2 * 12, bytes.size()) << "the root motion ends it";
    return out;
  };
  ChunkFrames other = in;
  for (uint32_t f = 0; f < 3; ++f) {
    std::fill_n(&other.labels[(f * 2 + 1) * 90], 90, kNoCamera);       // member 1
    std::fill_n(&other.offsets[(f * 2 + 0) * 20], 20, glm::ivec3(0));  // reference 0
  }
  const auto a = parts(in), b = parts(other);
  for (size_t p = 0; p < 7; ++p) EXPECT_EQ(a[p] == b[p], p != 3 && p != 4) << p;
}

// Zeros cost almost nothing, and a constant field as much as one vertex.
TEST(Chunk, SmoothFieldsAreSmall) {
  const ChunkMesh mesh = makeChunkMesh(cylinder(40, 100));
  ChunkFrames in{10, mesh.vertexCount(), mesh.faceCount(), 1, 2, 2, 1, {}, {}, {}, {}, {}};
  fillWithZeros(in);
  const size_t without = encodeChunk(in, mesh).take().size();
  EXPECT_LT(without, 700u);
  for (size_t i = 0; i < in.alignment.size(); ++i) in.alignment[i] = {int(i / mesh.vertexCount()) * 3, -20};
  EXPECT_LT(encodeChunk(in, mesh).take().size(), without + 100);
}

TEST(Chunk, RefusesTruncationTrailingBytesAndOtherCounts) {
  const ChunkFrames in = randomFrames(3, 20, 30, 3, 1, {3, 2, true});
  const ChunkMesh mesh = strandMesh(20, 30);
  const std::vector<uint8_t> bytes = encodeChunk(in, mesh).take();
  const StreamIndex index = indexFor(in);
  const auto refuse = [&](std::span<const uint8_t> part, const StreamIndex& i, uint32_t chunk, const ChunkMesh& m) {
    auto out = decodeChunk(part, i, chunk, m);
    ASSERT_FALSE(out.ok()) << part.size();
    EXPECT_EQ(out.error().id, ErrorId::StreamInvalid);
  };
  // Tests every truncation, on a smaller chunk.
  const ChunkFrames small = randomFrames(3, 8, 10, 2, 1, {2, 1, true});
  const ChunkMesh small_mesh = strandMesh(8, 10);
  const std::vector<uint8_t> small_bytes = encodeChunk(small, small_mesh).take();
  ASSERT_TRUE(decodeChunk(small_bytes, indexFor(small), 0, small_mesh).ok());
  for (size_t n = 0; n < small_bytes.size(); ++n)
    refuse(std::span(small_bytes).first(n), indexFor(small), 0, small_mesh);
  std::vector<uint8_t> longer = bytes;
  longer.push_back(7);
  refuse(longer, index, 0, mesh);
  for (size_t part = 0; part < 10; ++part) {  // moves a byte to the next part, the last one's to the root motion
    std::vector<uint8_t> moved = longer;
    ++moved[part * 4];
    refuse(moved, index, 0, mesh);
    moved.pop_back();
    refuse(moved, index, 0, mesh);
  }
  StreamIndex other = index;
  other.vertex_count = 21;
  refuse(bytes, other, 0, mesh);
  refuse(bytes, other, 0, strandMesh(21, 30));
  other = index;
  other.face_count = 31;
  refuse(bytes, other, 0, mesh);
  refuse(bytes, other, 0, strandMesh(20, 31));
  other = index;
  other.chunks[0].frame_count = 4;
  refuse(bytes, other, 0, mesh);
  other.chunks[0].frame_count = 2;
  refuse(bytes, other, 0, mesh);
  other = index;
  other.layer_count = 2;
  refuse(bytes, other, 0, mesh);
  other.layer_count = 7;
  refuse(bytes, other, 0, mesh);
  other = index;
  for (uint32_t members : {0u, 1u, 2u, 4u, 5u}) {
    other.member_count = members;
    refuse(bytes, other, 0, mesh);
    other.alignment_count = members - 1;
    refuse(bytes, other, 0, mesh);
  }
  other = index;
  for (uint32_t references : {0u, 1u, 3u, 33u}) {
    other.reference_count = references;
    refuse(bytes, other, 0, mesh);
  }
  other = index;
  other.alignment_count = 0;
  refuse(bytes, other, 0, mesh);
  refuse(bytes, index, 1, mesh);
}

TEST(Chunk, SurvivesDamage) {
  const ChunkFrames in = randomFrames(3, 8, 10, 2, 2, {2, 1, true});
  const ChunkMesh mesh = strandMesh(8, 10);
  const std::vector<uint8_t> bytes = encodeChunk(in, mesh).take();
  const auto expectInRange = [](int q) { EXPECT_LE(std::abs(q), 1 << 24); };
  for (size_t n = 0; n < bytes.size(); ++n) {
    std::vector<uint8_t> damaged = bytes;
    damaged[n] ^= std::array{0x55, 0x01, 0x80}[n % 3];
    auto out = decodeChunk(damaged, indexFor(in), 0, mesh);
    if (!out.ok()) continue;
    ASSERT_EQ(out.value().labels.size(), in.labels.size());
    for (uint8_t label : out.value().labels) EXPECT_TRUE(label < 31 || label == 255);
    for (const glm::ivec3& q : out.value().positions) expectInRange(q.x), expectInRange(q.y), expectInRange(q.z);
    for (const glm::ivec3& q : out.value().offsets) expectInRange(q.x), expectInRange(q.y), expectInRange(q.z);
    for (const glm::ivec2& q : out.value().alignment) expectInRange(q.x), expectInRange(q.y);
    for (const glm::vec3& r : out.value().root) EXPECT_LE(glm::length(r), 1.75e6f);
  }
}

TEST(Chunk, RefusesToEncodeWhatDoesNotFit) {
  const ChunkFrames good = randomFrames(1, 20, 30, 3, 3, {2, 1, true});
  const ChunkMesh mesh = strandMesh(20, 30);
  ASSERT_TRUE(encodeChunk(good, mesh).ok());
  ChunkFrames in = good;
  in.labels[4] = 31;
  EXPECT_FALSE(encodeChunk(in, mesh).ok());
  in = good;
  in.positions[3].y = -(1 << 24) - 1;
  EXPECT_FALSE(encodeChunk(in, mesh).ok());
  in = good;
  in.offsets[7].z = (1 << 24) + 1;
  EXPECT_FALSE(encodeChunk(in, mesh).ok());
  in = good;
  in.alignment[7].y = (1 << 24) + 1;
  EXPECT_FALSE(encodeChunk(in, mesh).ok());
  for (float root : {NAN, INFINITY, -2e6f}) {
    in = good;
    in.root[1].z = root;
    EXPECT_FALSE(encodeChunk(in, mesh).ok());
  }
  const auto refuseLess = [&](auto member) {
    ChunkFrames less = good;
    (less.*member).pop_back();
    EXPECT_FALSE(encodeChunk(less, mesh).ok());
  };
  refuseLess(&ChunkFrames::positions);
  refuseLess(&ChunkFrames::labels);
  refuseLess(&ChunkFrames::offsets);
  refuseLess(&ChunkFrames::alignment);
  refuseLess(&ChunkFrames::root);
  EXPECT_FALSE(encodeChunk(good, strandMesh(21, 30)).ok());
  EXPECT_FALSE(encodeChunk(good, strandMesh(20, 29)).ok());
}

// Decodes streams of version 7, forever: a change of layout or prediction needs a new version. (A corpus of another
// layout would be rejected at once, and fuzzing would test nothing.)
TEST(FuzzCorpus, StreamsDecodeToWhatTheyAlwaysDid) {
  const auto read = [](const char* name) {
    std::ifstream file(std::string(FOURDVT_SOURCE_DIR "/tests/fuzz/corpus/stream_fuzz/") + name, std::ios::binary);
    return std::vector<uint8_t>((std::istreambuf_iterator<char>(file)), {});
  };
  const std::vector<uint8_t> header = read("header.bin");
  ASSERT_GT(header.size(), 1u);
  EXPECT_TRUE(readStreamHeader(std::span(header).subspan(1)).ok());
  struct Frozen {
    const char* name;
    uint32_t checksum;
  };
  for (const Frozen& frozen :
       {Frozen{"chunk_class.bin", 1405100435}, {"chunk_random.bin", 2972114349}, {"chunk_still.bin", 1572331125}}) {
    const std::vector<uint8_t> chunk = read(frozen.name);
    ASSERT_GT(chunk.size(), 8u) << frozen.name;
    const ChunkFrames counts{1u + chunk[1],
                             3u + chunk[2],
                             1u + chunk[3],
                             1u + chunk[4],
                             1u + chunk[5],
                             chunk[6],
                             chunk[7],
                             {},
                             {},
                             {},
                             {},
                             {}};
    const ChunkMesh mesh = strandMesh(counts.vertex_count, counts.face_count);
    auto decoded = decodeChunk(std::span(chunk).subspan(8), indexFor(counts), 0, mesh);
    ASSERT_TRUE(decoded.ok()) << frozen.name << ": " << decoded.error().message;
    EXPECT_EQ(checksum(decoded.value()), frozen.checksum) << frozen.name;
  }
}

TEST(BaseMesh, KeepsGeometryAndReportsTheOrder) {
  MeshTopology topology;
  Positions positions;
  makeGrid(12, topology, positions);
  auto encoded = encodeBaseMesh(topology, positions);
  ASSERT_TRUE(encoded.ok()) << encoded.error().message;
  const EncodedBaseMesh& mesh = encoded.value();
  auto decoded = decodeBaseMesh(mesh.bytes);
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(decoded.value().topology.face_vertices, mesh.decoded.topology.face_vertices);
  EXPECT_EQ(decoded.value().positions, mesh.decoded.positions);
  ASSERT_EQ(mesh.source_face.size(), topology.face_vertices.size());
  ASSERT_EQ(mesh.source_vertex.size(), topology.vertex_count);
  std::vector<int> hits(topology.faceCount());
  for (uint32_t f = 0; f < mesh.source_face.size(); ++f) {
    ++hits[mesh.source_face[f]];
    uint32_t got = 0, want = 0;  // same three vertices
    for (int c = 0; c < 3; ++c) {
      got += 1u << (mesh.source_vertex[mesh.decoded.topology.face_vertices[f][c]] % 31);
      want += 1u << (topology.face_vertices[mesh.source_face[f]][c] % 31);
    }
    EXPECT_EQ(got, want);
  }
  for (int h : hits) EXPECT_EQ(h, 1);
  for (uint32_t v = 0; v < mesh.source_vertex.size(); ++v) {
    EXPECT_LT(glm::length(mesh.decoded.positions[v] - positions[mesh.source_vertex[v]]), 1.2f / 16383);
  }
}

TEST(BaseMesh, RefusesTruncationAndSurvivesDamage) {
  MeshTopology topology;
  Positions positions;
  makeGrid(4, topology, positions);
  const std::vector<uint8_t> bytes = encodeBaseMesh(topology, positions).take().bytes;
  for (size_t n = 0; n < bytes.size(); ++n) {
    EXPECT_FALSE(decodeBaseMesh(std::span(bytes).first(n)).ok()) << n;
    std::vector<uint8_t> damaged = bytes;
    damaged[n] ^= 0x5a;
    (void)decodeBaseMesh(damaged);
  }
}

TEST(BaseMesh, RefusesMoreFacesThanItShouldHave) {
  MeshTopology topology;
  Positions positions;
  makeGrid(6, topology, positions);
  const std::vector<uint8_t> bytes = encodeBaseMesh(topology, positions).take().bytes;
  EXPECT_TRUE(decodeBaseMesh(bytes, topology.faceCount()).ok());
  EXPECT_FALSE(decodeBaseMesh(bytes, topology.faceCount() - 1).ok());
}

TEST(Barcode, AllIndicesRoundTripAndSingleBitErrorsAreSeen) {
  for (uint32_t frame = 0; frame < 4096; ++frame) {
    const uint16_t bits = barcodeBits(frame);
    ASSERT_EQ(frameFromBarcode(bits), frame);
    for (int bit = 0; bit < 16; ++bit) ASSERT_FALSE(frameFromBarcode(bits ^ (1u << bit)).has_value());
  }
  EXPECT_EQ(barcodeBits(4096 + 7), barcodeBits(7));
}

TEST(Barcode, DrawnStripReadsBackFromEitherCopy) {
  BarcodeStrip strip{{4, 8, 32 * 16, 16}, 16};
  std::vector<uint8_t> luma(540 * 40, 90);
  I420View view{540, 40, luma.data(), nullptr, nullptr, 540, 0, 0};
  for (uint32_t frame : {0u, 1u, 1365u, 2730u, 4095u}) {
    drawBarcode(strip, frame, luma.data(), 540);
    EXPECT_EQ(readBarcode(strip, view), frame);
    for (int y = 8; y < 24; ++y) luma[y * 540 + 4 + 35] = luma[y * 540 + 4 + 36] = 128;  // scratches
    EXPECT_EQ(readBarcode(strip, view), frame);
    const uint8_t wrong = barcodeBits(frame) & 0x8000 ? 16 : 235;  // first copy's first cell destroyed
    for (int y = 8; y < 24; ++y) std::fill_n(luma.begin() + y * 540 + 4, 16, wrong);
    EXPECT_EQ(readBarcode(strip, view), frame);
  }
  strip.rect.x = 100;
  EXPECT_FALSE(readBarcode(strip, view).has_value());
}

// SPDX-License-Identifier: Apache-2.0
// The coders of labels and positions, each alone: round trips, sizes, and rejected bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "chunk_fixture.h"
#include "package/character.h"
#include "package/chunk_decoder.h"
#include "package/chunk_encode.h"
#include "package/label_model.h"
#include "package/position_model.h"

using namespace fourdvt;
using namespace fourdvt::package;
using fourdvt::testing::cylinder;
using fourdvt::testing::fillWithZeros;
using fourdvt::testing::strandMesh;

namespace {

ChunkFrames emptyFrames(const ChunkMesh& mesh, uint32_t frames, uint32_t layers) {
  return {frames, mesh.vertexCount(), mesh.faceCount(), layers, 1, 0, 0, {}, {}, {}, {}, {}};
}

// False unless the bytes are one whole part with the counts of `out`.
bool decodeLabels(std::span<const uint8_t> bytes, const ChunkMesh& mesh, ChunkFrames& out) {
  BinaryDecoder decoder(bytes);
  LabelModel model(decoder, mesh, out.layer_count);
  const size_t labels_per_frame = size_t(out.layer_count) * out.face_count;
  for (uint32_t f = 0; f < out.frame_count && !decoder.overrun(); ++f) {
    out.labels.resize((f + 1) * labels_per_frame);
    model.frame(&out.labels[f * labels_per_frame]);
  }
  return decoder.finished();
}

bool decodePositions(std::span<const uint8_t> bytes, const ChunkMesh& mesh, ChunkFrames& out) {
  PositionScale scale;
  if (bytes.size() < 8) return false;
  std::memcpy(&scale.base_scale, bytes.data(), 4);
  std::memcpy(&scale.residual_step, bytes.data() + 4, 4);
  BinaryDecoder decoder(bytes.subspan(8));
  PositionModel model(decoder, mesh, scale);
  for (uint32_t f = 0; f < out.frame_count && !decoder.overrun(); ++f) {
    out.positions.resize(size_t(f + 1) * out.vertex_count);
    if (!model.frame(&out.positions[size_t(f) * out.vertex_count])) return false;
  }
  return decoder.finished();
}

void expectRoundTrip(const ChunkFrames& in, const ChunkMesh& mesh) {
  const std::vector<uint8_t> bytes = encodeLabels(in, mesh, 0);
  ChunkFrames out = emptyFrames(mesh, in.frame_count, in.layer_count);
  ASSERT_TRUE(decodeLabels(bytes, mesh, out));
  EXPECT_EQ(out.labels, in.labels);
}

// Labels of cameras round a turning cylinder: the L nearest of 8, nearest first.
ChunkFrames movingSeams(const ChunkMesh& mesh, uint32_t around, uint32_t frames, uint32_t layers) {
  ChunkFrames out = emptyFrames(mesh, frames, layers);
  for (uint32_t f = 0; f < frames; ++f) {
    for (uint32_t l = 0; l < layers; ++l) {
      for (uint32_t i = 0; i < mesh.faceCount(); ++i) {
        const uint32_t row = i / 2 / around;
        const double wobble = 0.15 * std::sin(row * 0.37) + 0.1 * std::sin(row * 0.11 + f * 0.05);
        const double camera = 8.0 * (i / 2 % around + 0.5 * (i % 2)) / around + 0.035 * f + wobble + 8;
        const int nearest = int(std::floor(camera + 0.5)), side = camera > nearest ? 1 : -1;
        const int offsets[6] = {0, side, -side, 2 * side, -2 * side, 3 * side};
        out.labels.push_back(static_cast<uint8_t>((nearest + offsets[l] + 8) % 8));
      }
    }
  }
  return out;
}

}  // namespace

TEST(LabelCoder, GivesBackRandomLabelsOfAnyShape) {
  std::mt19937 random(5);
  struct Shape {
    uint32_t vertices, faces, layers, frames;
  };
  for (const Shape& s : {Shape{40, 60, 3, 5}, {3, 1, 1, 1}, {3, 1, 6, 7}, {30, 20, 6, 1}, {9, 100, 2, 20}}) {
    const ChunkMesh mesh = strandMesh(s.vertices, s.faces);
    ChunkFrames in = emptyFrames(mesh, s.frames, s.layers);
    for (uint32_t i = 0; i < s.faces * s.layers * s.frames; ++i) {
      const uint32_t r = random() % 32;  // all 31 cameras
      in.labels.push_back(r == 31 ? kNoCamera : static_cast<uint8_t>(r));
    }
    expectRoundTrip(in, mesh);
  }
}

TEST(LabelCoder, RandomLabelsCostNoMoreThanTheirInformation) {
  std::mt19937 random(6);
  const ChunkMesh mesh = makeChunkMesh(cylinder(20, 50));
  ChunkFrames in = emptyFrames(mesh, 4, 3);
  for (uint32_t i = 0; i < 4 * 3 * mesh.faceCount(); ++i) in.labels.push_back(random() % 8);
  EXPECT_LT(encodeLabels(in, mesh, 0).size(), in.labels.size() * 3 / 8 * 1.25);  // 3 bits a label
}

TEST(LabelCoder, StillAndEmptyLabelsCostNearlyNothing) {
  const ChunkMesh mesh = makeChunkMesh(cylinder(40, 100));  // 8,000 faces
  ChunkFrames in = emptyFrames(mesh, 20, 3);
  in.labels.assign(size_t(20) * 3 * mesh.faceCount(), kNoCamera);
  expectRoundTrip(in, mesh);
  EXPECT_LT(encodeLabels(in, mesh, 0).size(), 40u);
  const ChunkFrames moving = movingSeams(mesh, 40, 1, 3);
  for (uint32_t f = 0; f < 20; ++f)
    std::copy(moving.labels.begin(), moving.labels.end(), in.labels.begin() + f * moving.labels.size());
  expectRoundTrip(in, mesh);
  EXPECT_LT(encodeLabels(in, mesh, 0).size(), encodeLabels(moving, mesh, 0).size() + 100);
}

TEST(LabelCoder, MovingSeamsAreFollowed) {
  const ChunkMesh mesh = makeChunkMesh(cylinder(40, 100));
  const ChunkFrames in = movingSeams(mesh, 40, 20, 3);
  size_t changed = 0;
  for (size_t i = 3 * mesh.faceCount(); i < in.labels.size(); ++i)
    changed += in.labels[i] != in.labels[i - 3 * mesh.faceCount()];
  ASSERT_GT(changed, 19u * 3 * mesh.faceCount() / 20) << "the field must move: 5 % of all labels a frame";
  expectRoundTrip(in, mesh);
  EXPECT_LT(encodeLabels(in, mesh, 0).size() / 20, 85u) << "bytes a frame";
}

TEST(LabelCoder, RefusesOtherLengthsAndOnlyEverGivesLabels) {
  const ChunkMesh mesh = strandMesh(30, 50);
  ChunkFrames in = emptyFrames(mesh, 4, 3);
  std::mt19937 random(8);
  for (uint32_t i = 0; i < 4 * 3 * 50; ++i) in.labels.push_back(random() % 5 ? 1 : kNoCamera);
  std::vector<uint8_t> bytes = encodeLabels(in, mesh, 0);
  for (size_t n = 0; n < bytes.size(); ++n) {
    ChunkFrames out = emptyFrames(mesh, 4, 3);
    EXPECT_FALSE(decodeLabels(std::span(bytes).first(n), mesh, out)) << n;
  }
  for (int round = 0; round < 600; ++round) {
    std::vector<uint8_t> damaged = bytes;
    for (int edits = 1 + round % 4; edits > 0; --edits) damaged[random() % damaged.size()] ^= 1u << random() % 8;
    ChunkFrames out = emptyFrames(mesh, 4, 3);
    if (!decodeLabels(damaged, mesh, out)) continue;
    ASSERT_EQ(out.labels.size(), in.labels.size());
    for (uint8_t label : out.labels) ASSERT_TRUE(label < kMaxCameras || label == kNoCamera);
  }
  bytes.push_back(0);
  ChunkFrames out = emptyFrames(mesh, 4, 3);
  EXPECT_FALSE(decodeLabels(bytes, mesh, out));
}

TEST(LabelCoder, AHugeFrameCountDoesNotAllocateWhatTheBytesDoNotHold) {
  const ChunkMesh mesh = strandMesh(30, 50);
  ChunkFrames out = emptyFrames(mesh, 65535, 6);
  EXPECT_FALSE(decodeLabels(std::vector<uint8_t>(40, 0x5a), mesh, out));
  EXPECT_LT(out.labels.size(), 3000u * 6 * 50);
}

TEST(PositionCoder, ARigidMotionCostsOnlyItsRounding) {
  const BaseMesh base = cylinder(40, 100);
  const ChunkMesh mesh = makeChunkMesh(base);
  ChunkFrames in = emptyFrames(mesh, 12, 1);
  for (uint32_t f = 0; f < in.frame_count; ++f) {
    const double angle = 0.15 * f, c = std::cos(angle), s = std::sin(angle);
    for (const glm::dvec3 p : base.positions)
      in.positions.emplace_back(glm::round(glm::dvec3(c * p.x + s * p.z + 0.04 * f, p.y, c * p.z - s * p.x) / 0.00025));
  }
  const std::vector<uint8_t> bytes = encodePositions(in, mesh, 0, 1);
  ChunkFrames out = emptyFrames(mesh, 12, 1);
  ASSERT_TRUE(decodePositions(bytes, mesh, out));
  EXPECT_EQ(out.positions, in.positions);
  // Rounding by half a step either way leaves about 1.5 bits per coordinate.
  EXPECT_LT(bytes.size() * 8.0 / (12.0 * 3 * mesh.vertexCount()), 1.9);
}

// Not even its rounding, if residuals have a step: the motion is predicted between whole steps.
TEST(PositionCoder, ARigidMotionOnAFineGridCostsNothing) {
  const BaseMesh base = cylinder(40, 100);
  const ChunkMesh mesh = makeChunkMesh(base);
  const auto bytesOf = [&](uint32_t frames) {
    ChunkFrames in = emptyFrames(mesh, frames, 1);
    for (uint32_t f = 0; f < frames; ++f)
      for (const glm::dvec3 p : base.positions)
        in.positions.emplace_back(glm::round(glm::dvec3(p.x + 0.0437 * f, p.y, p.z - 0.0211 * f) / (0.001 / 16)));
    return encodePositions(in, mesh, 0, 16).size();
  };
  EXPECT_LT((bytesOf(12) - bytesOf(1)) * 8.0 / (11.0 * 3 * mesh.vertexCount()), 0.02);
}

TEST(PositionCoder, GivesBackExtremesAndRefusesOtherLengths) {
  const ChunkMesh mesh = strandMesh(20, 30);
  ChunkFrames in = emptyFrames(mesh, 3, 1);
  std::mt19937 random(9);
  for (uint32_t i = 0; i < 3 * 20; ++i) {
    const auto end = [&] { return random() % 2 ? 1 << 24 : -(1 << 24); };
    in.positions.emplace_back(end(), end(), int(random() % (1 << 25)) - (1 << 24));
  }
  const std::vector<uint8_t> bytes = encodePositions(in, mesh, 0, 1);
  ChunkFrames out = emptyFrames(mesh, 3, 1);
  ASSERT_TRUE(decodePositions(bytes, mesh, out));
  EXPECT_EQ(out.positions, in.positions);
  for (size_t n = 0; n < bytes.size(); ++n) {
    ChunkFrames partial = emptyFrames(mesh, 3, 1);
    EXPECT_FALSE(decodePositions(std::span(bytes).first(n), mesh, partial)) << n;
  }
}

TEST(ChunkMesh, LinksFacesAcrossEdges) {
  BaseMesh square;  // 2 - 3
  square.positions = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {2, 1, 0}};
  square.topology.vertex_count = 4;
  square.topology.face_vertices = {{0, 1, 2}, {1, 3, 2}, {1, 0, 3}, {2, 1, 0}};  // the last two: used edges
  const ChunkMesh mesh = makeChunkMesh(square);
  using Three = std::array<uint32_t, 3>;
  EXPECT_EQ(mesh.face_neighbours[0], (Three{2, 1, 3}));  // edges 01, 12, 20
  EXPECT_EQ(mesh.face_neighbours[1], (Three{2, kNoFace, 0}));
  EXPECT_EQ(mesh.face_neighbours[2], (Three{0, kNoFace, 1}));
  EXPECT_EQ(mesh.face_neighbours[3], (Three{kNoFace, kNoFace, 0}));
  EXPECT_EQ(mesh.base[3], glm::ivec3(16383, 8192, 0));
}

// A path of 70 vertices, each sharing an edge with those one and two further: distances are halves, rounded up.
TEST(ChunkMesh, OrdersVerticesFromCoarseToFine) {
  const ChunkMesh mesh = strandMesh(70, 68);
  const std::vector<uint32_t> coarse(mesh.order.begin(), mesh.order.begin() + 5);
  EXPECT_EQ(coarse, (std::vector<uint32_t>{0, 63, 31, 15, 46})) << "rounds of 32, 16 and 8 edges";
  std::vector<uint32_t> sorted = mesh.order;
  std::sort(sorted.begin(), sorted.end());
  for (uint32_t v = 0; v < 70; ++v) EXPECT_EQ(sorted[v], v);
  std::vector<uint32_t> place(70);
  for (uint32_t i = 0; i < 70; ++i) place[mesh.order[i]] = i;
  const auto edges = [](uint32_t a, uint32_t b) { return (std::max(a, b) - std::min(a, b) + 1) / 2; };
  for (uint32_t v = 0; v < 70; ++v) {
    const auto earlier = mesh.earlierOf(v);
    ASSERT_TRUE(v == 0 || !earlier.empty()) << v;
    for (size_t i = 0; i < earlier.size(); ++i) {
      EXPECT_LT(place[earlier[i]], place[v]);
      EXPECT_EQ(i < mesh.ring_count[v], edges(v, earlier[i]) == edges(v, earlier[0])) << v;
      EXPECT_LE(edges(v, earlier[i > 0 ? i - 1 : 0]), edges(v, earlier[i])) << v;
    }
  }
  EXPECT_TRUE(mesh.last_round[mesh.order.back()]);
  EXPECT_FALSE(mesh.last_round[46]);
}

TEST(ChunkMesh, AFanOfManyFacesIsBuiltInLinearTime) {
  BaseMesh fan;
  const uint32_t count = 200000;
  for (uint32_t v = 0; v <= count; ++v) fan.positions.emplace_back(std::cos(v * 0.1f), std::sin(v * 0.1f), v * 1e-5f);
  for (uint32_t v = 1; v < count; ++v) fan.topology.face_vertices.emplace_back(0, v, v + 1);
  const ChunkMesh mesh = makeChunkMesh(fan);
  EXPECT_EQ(mesh.earlierOf(count).size(), 10u);
  EXPECT_EQ(mesh.ring_count[count], 2);
}

TEST(ChunkDecoder, DecodesNoFurtherThanAsked) {
  const BaseMesh base = cylinder(20, 20);
  const ChunkMesh mesh = makeChunkMesh(base);
  ChunkFrames in = movingSeams(mesh, 20, 6, 3);
  for (uint32_t f = 0; f < 6; ++f)
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v) in.positions.emplace_back(int(f * v), int(v), -int(f));
  fillWithZeros(in);
  const auto bytes = encodeChunk(in, mesh);
  ASSERT_TRUE(bytes);
  StreamIndex index;
  index.frame_count = 6;
  index.vertex_count = mesh.vertexCount();
  index.face_count = mesh.faceCount();
  index.layer_count = 3;
  index.chunks.push_back({0, 6, 0, static_cast<uint32_t>(bytes.value().size())});
  auto decoder = ChunkDecoder::open(bytes.value(), index, 0, mesh);
  ASSERT_TRUE(decoder);
  EXPECT_EQ(decoder.value()->decodedCount(), 0u);
  ASSERT_TRUE(decoder.value()->decodeTo(2).ok());
  EXPECT_EQ(decoder.value()->decodedCount(), 3u);
  ASSERT_TRUE(decoder.value()->decodeTo(1).ok());
  EXPECT_EQ(decoder.value()->decodedCount(), 3u) << "back costs nothing";
  ASSERT_TRUE(decoder.value()->decodeTo(99).ok());
  EXPECT_EQ(decoder.value()->frames().positions, in.positions);
  EXPECT_EQ(decoder.value()->frames().labels, in.labels);
}

TEST(ChunkDecoder, StaysBrokenWhereTheBytesEnd) {
  const BaseMesh base = cylinder(20, 20);
  const ChunkMesh mesh = makeChunkMesh(base);
  ChunkFrames in = movingSeams(mesh, 20, 6, 1);
  std::mt19937 random(3);
  for (uint32_t i = 0; i < 6 * mesh.vertexCount(); ++i) in.positions.emplace_back(random() % 1000, random() % 1000, 0);
  fillWithZeros(in);
  std::vector<uint8_t> bytes = encodeChunk(in, mesh).take();
  StreamIndex index;
  index.frame_count = 6;
  index.vertex_count = mesh.vertexCount();
  index.face_count = mesh.faceCount();
  index.layer_count = 1;
  index.chunks.push_back({0, 6, 0, 0});
  // Half of the positions, all of the labels.
  uint32_t position_bytes = 0;
  std::memcpy(&position_bytes, bytes.data(), 4);
  bytes.erase(bytes.begin() + 8 + position_bytes / 2, bytes.begin() + 8 + position_bytes);
  position_bytes /= 2;
  std::memcpy(bytes.data(), &position_bytes, 4);
  auto decoder = ChunkDecoder::open(bytes, index, 0, mesh);
  ASSERT_TRUE(decoder);
  EXPECT_TRUE(decoder.value()->decodeTo(1).ok()) << "the frames before are good";
  EXPECT_FALSE(decoder.value()->decodeTo(5).ok());
  EXPECT_FALSE(decoder.value()->decodeTo(1).ok());
  EXPECT_LT(decoder.value()->decodedCount(), 6u);
}

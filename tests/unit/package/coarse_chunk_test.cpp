// SPDX-License-Identifier: Apache-2.0
// Chunks with residual steps: error bounds, and values that are preserved exactly.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "chunk_fixture.h"
#include "package/chunk_encode.h"

using namespace fourdvt;
using namespace fourdvt::package;
using fourdvt::testing::indexFor;
using fourdvt::testing::strandMesh;

namespace {

constexpr uint32_t kFrames = 9, kVertices = 40, kFaces = 60;

// A wavy motion with noise of up to two steps, of two members with one correction and alignment.
ChunkFrames wavyFrames() {
  ChunkFrames in;
  in.frame_count = kFrames, in.vertex_count = kVertices, in.face_count = kFaces, in.layer_count = 3;
  in.member_count = 2, in.reference_count = 1, in.alignment_count = 1;
  for (uint32_t i = 0; i < kFrames * 2 * kVertices; ++i) {
    const double f = i / kVertices, v = i % kVertices;
    in.positions.emplace_back(900 * std::sin(0.2 * v + 0.1 * f), 40 * v + 30 * std::sin(0.3 * f),
                              500 * std::cos(0.15 * v) + (i * 7 + i / 11) % 3);
  }
  for (int i = 0; i < int(kFrames * kVertices); ++i) {
    in.offsets.emplace_back(i % 7 - 3, i * 5 % 11 - 5, i * 3 % 13 - 6);
    in.alignment.emplace_back(i * 3 % 9 - 4, i * 7 % 15 - 7);
  }
  for (uint32_t i = 0; i < kFrames * 2 * 3 * kFaces; ++i) in.labels.push_back(uint8_t(i / 50 % 5));
  for (uint32_t i = 0; i < kFrames * 2; ++i) in.root.emplace_back(0.01f * i, 0.02f * i, 0);
  return in;
}

// Largest error along any axis, in residual steps.
template <int N>
double errorOf(const std::vector<glm::vec<N, int>>& exact, const std::vector<glm::vec<N, int>>& coded, uint32_t step) {
  int largest = 0;
  for (size_t i = 0; i < exact.size(); ++i)
    for (int k = 0; k < N; ++k) largest = std::max(largest, std::abs(coded[i][k] - exact[i][k]));
  return double(largest) / step;
}

}  // namespace

TEST(CoarseChunk, ValuesStayWithinTheDeadZone) {
  const ChunkFrames in = wavyFrames();
  const ChunkMesh mesh = strandMesh(kVertices, kFaces);
  size_t before = encodeChunk(in, mesh).take().size();
  for (const uint32_t step : {4u, 16u}) {
    const auto bytes = encodeChunk(in, mesh, {step, step / 2}).take();
    const ChunkFrames out = decodeChunk(bytes, indexFor(in), 0, mesh).take();
    for (const double error : {errorOf(in.positions, out.positions, step), errorOf(in.offsets, out.offsets, step),
                               errorOf(in.alignment, out.alignment, step / 2)}) {
      EXPECT_LT(error, 0.7);
      EXPECT_GE(error, 0.5) << "rounding alone would stay below, or at it";
    }
    EXPECT_EQ(out.labels, in.labels);
    EXPECT_EQ(out.root, in.root);
    EXPECT_LT(bytes.size(), before);
    before = bytes.size();
  }
}

TEST(CoarseChunk, VerticesThatOthersArePredictedFromAreTwiceAsFine) {
  const ChunkFrames in = wavyFrames();
  const ChunkMesh mesh = strandMesh(kVertices, kFaces);
  const ChunkFrames out = decodeChunk(encodeChunk(in, mesh, {16, 1}).take(), indexFor(in), 0, mesh).take();
  int largest = 0, others = 0;
  for (size_t i = 0; i < in.positions.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      int& error = mesh.last_round[i % kVertices] ? others : largest;
      error = std::max(error, std::abs(out.positions[i][k] - in.positions[i][k]));
    }
  EXPECT_LT(largest, 0.7 * 8);
  EXPECT_GT(others, 0.7 * 8);
}

TEST(CoarseChunk, TheFirstFrameAloneHasTheSameValues) {
  ChunkFrames in = wavyFrames();
  const ChunkMesh mesh = strandMesh(kVertices, kFaces);
  const auto bytes = encodeChunk(in, mesh, {16, 4}).take();
  ChunkFrames first = decodeChunk(bytes, indexFor(in), 0, mesh).take();
  first.frame_count = 1;
  first.positions.resize(2 * kVertices), first.labels.resize(2 * 3 * kFaces);
  first.offsets.resize(kVertices), first.alignment.resize(kVertices), first.root.resize(2);
  const auto alone = encodeFirstFrame(bytes, first, mesh).take();
  const ChunkFrames out = decodeChunk(alone, indexFor(first), 0, mesh).take();
  EXPECT_TRUE(fourdvt::testing::sameChunk(out, first));
  EXPECT_LT(alone.size(), encodeChunk(first, mesh).take().size()) << "lossless";
}

TEST(CoarseChunk, RefusesStepsAndValuesOutOfRange) {
  ChunkFrames in = wavyFrames();
  const ChunkMesh mesh = strandMesh(kVertices, kFaces);
  EXPECT_FALSE(encodeChunk(in, mesh, {0, 1}).ok());
  EXPECT_FALSE(encodeChunk(in, mesh, {1, 0}).ok());
  EXPECT_FALSE(encodeChunk(in, mesh, {4097, 1}).ok());
  std::vector<uint8_t> bytes = encodeChunk(in, mesh, {4096, 1}).take();
  EXPECT_TRUE(decodeChunk(bytes, indexFor(in), 0, mesh).ok());
  const size_t step_at = 4 * 6 + 4;  // after the parts' lengths and the base scale
  ASSERT_EQ(bytes[step_at] | bytes[step_at + 1] << 8, 4096);
  for (const int step : {0, 4097}) {
    bytes[step_at] = uint8_t(step), bytes[step_at + 1] = uint8_t(step >> 8);
    EXPECT_FALSE(decodeChunk(bytes, indexFor(in), 0, mesh).ok()) << step;
  }
  in.positions[5].x = 1 << 24;
  EXPECT_TRUE(encodeChunk(in, mesh, {1, 1}).ok());
  EXPECT_FALSE(encodeChunk(in, mesh, {16, 1}).ok()) << "an error of coding could lead out of range";
}

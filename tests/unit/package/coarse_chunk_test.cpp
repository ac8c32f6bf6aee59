// SPDX-License-Identifier: Apache-2.0
// Coarse chunks: error bounds, and values that are preserved exactly.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "chunk_fixture.h"

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

// Largest error along any axis, in coarse steps.
template <int N>
double errorOf(const std::vector<glm::vec<N, int>>& exact, const std::vector<glm::vec<N, int>>& coarse, double scale) {
  double largest = 0;
  for (size_t i = 0; i < exact.size(); ++i)
    for (int k = 0; k < N; ++k) largest = std::max(largest, std::abs(coarse[i][k] - exact[i][k] / scale));
  return largest;
}

}  // namespace

TEST(CoarseChunk, ValuesStayWithinTheDeadZone) {
  const ChunkFrames in = wavyFrames();
  const ChunkMesh mesh = strandMesh(kVertices, kFaces);
  size_t before = encodeChunk(in, mesh).take().size();
  for (const double scale : {2.0, 8.0}) {
    const auto bytes = encodeCoarseChunk(in, mesh, scale).take();
    const ChunkFrames out = decodeChunk(bytes, indexFor(in), 0, mesh).take();
    for (const double error : {errorOf(in.positions, out.positions, scale), errorOf(in.offsets, out.offsets, scale),
                               errorOf(in.alignment, out.alignment, scale)}) {
      EXPECT_LE(error, 0.8 + 1e-9);
      EXPECT_GT(error, scale > 2 ? 0.5 : 0.49) << "rounding alone would stay below, or at it";
    }
    EXPECT_EQ(out.labels, in.labels);
    EXPECT_EQ(out.root, in.root);
    EXPECT_LT(bytes.size(), before);
    before = bytes.size();
  }
  EXPECT_FALSE(encodeCoarseChunk(in, mesh, 0.5).ok());
}

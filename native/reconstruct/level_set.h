// SPDX-License-Identifier: Apache-2.0
// Signed distances on a sparse regular grid, and their zero surface (OpenVDB's adaptive meshing).
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::reconstruct {

inline constexpr int kBlock = 8;  // voxels along each side

struct SparseDistance {
  double voxel_m = 0;
  glm::dvec3 origin_in_world{0};  // position of voxel (0, 0, 0), metres
  float band_m = 0;               // distances are clamped to ± this
  struct Block {
    glm::ivec3 at{0};                                    // first voxel, a multiple of kBlock
    std::array<float, kBlock * kBlock * kBlock> values;  // metres, positive inside; x slowest, z fastest
  };
  std::vector<Block> blocks;       // may contain the surface
  std::vector<glm::ivec3> inside;  // entirely inside
  size_t cells_judged = 0;         // cells of all sizes classified during carving
};
using BlockValues = decltype(SparseDistance::Block::values);

// Voxel coordinates of value `i` of a block.
inline glm::ivec3 voxelOf(const SparseDistance::Block& block, size_t i) {
  return block.at + glm::ivec3(int(i >> 6), int(i >> 3 & 7), int(i & 7));
}

// Unique for blocks within a million voxels of the origin.
inline uint64_t blockKey(const glm::ivec3& at) {
  constexpr uint64_t kMask = (1u << 21) - 1;
  return (uint64_t(at.x) & kMask) << 42 | (uint64_t(at.y) & kMask) << 21 | (uint64_t(at.z) & kMask);
}

// Adds the blocks in `inside` to those with values, `band_m` everywhere.
SparseDistance withValuesInside(const SparseDistance& distance);
// Removes blocks entirely outside, and the values of those entirely inside.
void compact(SparseDistance& distance);

// Extracts the zero surface; closed if the distance is negative on the grid's border. `adaptivity`: 0 one vertex per
// crossed voxel, up to 1 fewer and larger faces where the surface is flat. Components may touch in a point.
TriangleMesh zeroSurface(const SparseDistance& distance, double adaptivity);

}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
// A signed distance on a sparse regular grid, and the surface where it is zero (OpenVDB's adaptive meshing). Does NOT
// know where the distance comes from.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::reconstruct {

inline constexpr int kBlock = 8;  // voxels along each side of a block

struct SparseDistance {
  double voxel_m = 0;
  glm::dvec3 origin_in_world{0};  // of voxel (0, 0, 0), metres
  float band_m = 0;               // distances are cut off at plus and minus this
  struct Block {
    glm::ivec3 at{0};                                    // first voxel, a multiple of kBlock
    std::array<float, kBlock * kBlock * kBlock> values;  // metres, positive inside; x slowest, z fastest
  };
  std::vector<Block> blocks;       // those that the surface may cross
  std::vector<glm::ivec3> inside;  // blocks that lie inside as a whole
  size_t cells_judged = 0;         // of all sizes, on the way to the blocks
};
using BlockValues = decltype(SparseDistance::Block::values);

// The voxel of value `i` of a block.
inline glm::ivec3 voxelOf(const SparseDistance::Block& block, size_t i) {
  return block.at + glm::ivec3(int(i >> 6), int(i >> 3 & 7), int(i & 7));
}

// Different for different blocks within a million voxels of the origin.
inline uint64_t blockKey(const glm::ivec3& at) {
  constexpr uint64_t kMask = (1u << 21) - 1;
  return (uint64_t(at.x) & kMask) << 42 | (uint64_t(at.y) & kMask) << 21 | (uint64_t(at.z) & kMask);
}

// The same distance with values in all blocks: those inside follow the others, `band_m` deep everywhere.
SparseDistance withValuesInside(const SparseDistance& distance);
// Leaves out the blocks that lie outside as a whole, and keeps no values of those inside.
void compact(SparseDistance& distance);

// Closed wherever the distance is negative on the border of what is given. `adaptivity`: 0 one vertex per crossed
// voxel, up to 1 fewer and larger faces where the surface is flat. One component may touch another in a point.
TriangleMesh zeroSurface(const SparseDistance& distance, double adaptivity);

}  // namespace fourdvt::reconstruct

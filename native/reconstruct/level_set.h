// SPDX-License-Identifier: Apache-2.0
// A signed distance on a sparse regular grid, and the surface where it is zero (OpenVDB's adaptive meshing). Does NOT
// know where the distance comes from.
#pragma once

#include <array>
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
};

// Closed wherever the distance is negative on the border of what is given. `adaptivity`: 0 one vertex per crossed
// voxel, up to 1 fewer and larger faces where the surface is flat. One component may touch another in a point.
TriangleMesh zeroSurface(const SparseDistance& distance, double adaptivity);

}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
// Values of a sparse distance between its voxels. Does NOT change it.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "reconstruct/level_set.h"

namespace fourdvt::reconstruct {

// Finds the blocks of a grid by their places. Distances on the same blocks share one.
class BlockIndex {
 public:
  explicit BlockIndex(std::span<const SparseDistance::Block> blocks);
  // Index of the block that holds a voxel; -1: none.
  int find(const glm::ivec3& voxel) const;

 private:
  struct Slot {
    uint64_t key = 0;
    int block = -1;
  };
  std::vector<Slot> slots_;  // open addressing, a power of two
  size_t mask_ = 0;
};

// Trilinear; minus the band where there is no block. Borrows both, which have the same blocks and none inside.
class DistanceSampler {
 public:
  DistanceSampler(const SparseDistance& distance, const BlockIndex& index)
      : distance_(distance), index_(index), per_voxel_(1 / distance.voxel_m) {}
  float at(const glm::dvec3& point_in_world) const;

 private:
  float voxel(const glm::ivec3& at) const;

  const SparseDistance& distance_;
  const BlockIndex& index_;
  double per_voxel_;
};

}  // namespace fourdvt::reconstruct

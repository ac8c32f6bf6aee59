// SPDX-License-Identifier: Apache-2.0
// Fuses depth maps and a hull into one signed distance inside the hull, and fills regions without depths by a membrane.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "reconstruct/level_set.h"
#include "reconstruct/stereo/plane_sweep.h"

namespace fourdvt::reconstruct {
struct FusionOptions {
  double truncation_m = 0.03;  // maximum depth behind a map's surface with data
  double hull_stays_m =
      0.003;                 // maps no deeper than this are ignored; from three times as much on they replace the hull
  double min_weight = 0.25;  // minimum total weight of the maps; below, the hull is kept
};

// Fused distance on the hull's grid.
struct FusedDistance {
  SparseDistance distance;         // values in all blocks of the hull
  std::vector<BlockValues> trust;  // [block] total weight of the maps; 0: no data, hull value
};

FusedDistance fuseDepths(const SparseDistance& hull, std::span<const DepthMap> maps, const FusionOptions& options);

struct MembraneOptions {
  double stiffness = 2;  // weight of each of six neighbours, relative to a map's weight of 0 … 1; 0: no membrane
  int thin_voxels = 5;   // radius: the hull is thin where no voxel within it is as deep as the band
  int reach_voxels =
      16;  // the hull is kept beyond this distance from depth data, partly from half of it on; 0: no limit
  int rounds = 20;
};

// Interpolates the distance where maps have no data: fills pits and tunnels dug by wrong depths. `hull` has values in
// all blocks (withValuesInside), `distance` the same blocks, `trust` a weight per voxel; 0: no data. Minimises Σ trust
// (u − distance)² + stiffness Σ (u − u of each neighbour)² by Jacobi iterations, at most the hull, and at least
// `distance` where trust is above 0. Thin parts without data, such as fingers, and regions far from data keep the hull.
// Without depth data the hull is unchanged.
void spanMembrane(const SparseDistance& hull, std::span<const BlockValues> trust, const MembraneOptions& options,
                  SparseDistance& distance);

// Spatial hash of a grid's blocks. Distances on the same blocks can share one.
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

// Interpolates distances trilinearly; -band_m outside the blocks. Borrows distance and index, which have the same
// blocks; requires an empty `inside`. Not for several threads.
class DistanceSampler {
 public:
  DistanceSampler(const SparseDistance& distance, const BlockIndex& index)
      : distance_(distance), index_(index), per_voxel_(1 / distance.voxel_m) {}
  float at(const glm::dvec3& point_in_world) const;

 private:
  int blockOf(const glm::ivec3& voxel) const;

  const SparseDistance& distance_;
  const BlockIndex& index_;
  double per_voxel_;
  mutable glm::ivec3 last_at_{1};  // the block found last, of nearby points on a ray; 1: none
  mutable int last_block_ = -1;
};

}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
// Depth maps and a hull to one signed distance. Does NOT leave the hull, and leaves it alone where no map knows better.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "reconstruct/level_set.h"
#include "reconstruct/stereo/plane_sweep.h"

namespace fourdvt::reconstruct {
struct FusionOptions {
  double truncation_m = 0.03;   // what lies deeper behind a map's surface is unknown to it
  double hull_stays_m = 0.003;  // the hull stays where the maps go no deeper than this; from thrice as much on they win
  double least_weight = 0.25;   // of all maps together; below, the hull stays
};

// On the hull's grid.
struct FusedDistance {
  SparseDistance distance;         // with values in all blocks of the hull
  std::vector<BlockValues> trust;  // by block: weight of the maps; 0: they know nothing and the hull stays
};

FusedDistance fuseDepths(const SparseDistance& hull, std::span<const DepthMap> maps, const FusionOptions& options);

// Spans the distance where the maps leave it open, as a membrane would: pits and tunnels that wrong depths have dug are
// filled, and what no map knows follows its surroundings instead of the hull. Does NOT dig where maps know the surface
// or where the hull is thin, as at fingers, and nothing leaves the hull.

struct MembraneOptions {
  double stiffness = 2;  // of the pull towards each of six neighbours, beside a map's weight of 0 … 1; 0: no membrane
  int thin_voxels = 5;   // the hull is thin where no voxel so near lies deeper in it than the band
  int reach_voxels = 16;  // beyond this from what a map knows the hull stays, from half of it on partly; 0: everywhere
  int rounds = 20;
};

// `hull` has values in all blocks (withValuesInside), `distance` has the same blocks, `trust` a weight for each of
// their voxels; 0: no map knows it. Minimises Σ trust (u − distance)² + stiffness Σ (u − u of each neighbour)² by
// rounds of Jacobi's method, never above the hull, and never below `distance` where trust is above 0. What is thin and
// not known keeps the hull, and so does what lies far from anything known: no map knows anything, nothing changes.
void spanMembrane(const SparseDistance& hull, std::span<const BlockValues> trust, const MembraneOptions& options,
                  SparseDistance& distance);

// Values of a sparse distance between its voxels. Does NOT change it.

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

// SPDX-License-Identifier: Apache-2.0
// Spans the distance where the maps leave it open, as a membrane would: pits and tunnels that wrong depths have dug are
// filled, and what no map knows follows its surroundings instead of the hull. Does NOT dig where maps know the surface
// or where the hull is thin, as at fingers, and nothing leaves the hull.
#pragma once

#include <span>

#include "reconstruct/level_set.h"

namespace fourdvt::reconstruct {

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

}  // namespace fourdvt::reconstruct

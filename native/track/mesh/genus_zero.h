// SPDX-License-Identifier: Apache-2.0
// Closed surface of genus 0 around the solid that an unclean surface bounds, e.g. a reconstruction with handles, holes
// of some triangles, or parts in contact.
#pragma once

#include <cstddef>

#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::track {

struct GenusZeroSurface {
  TriangleMesh mesh;    // one component, manifold, Euler characteristic 2
  double cut_m3 = 0;    // volume that was left out, so that handles open and contacts part
  double other_m3 = 0;  // volume of components besides the largest
};

// Fills the largest solid that `surface` bounds on a grid of `voxel_m`, from its deepest voxel outwards, and leaves out
// voxels that would close a handle. Source of the topology control: Bischoff, Kobbelt: Isosurface Reconstruction with
// Topology Control. Pacific Graphics 2002. Detail below two voxels is lost. Errors: MeshTopology (bounds no solid).
Result<GenusZeroSurface> genusZeroSurface(const TriangleMesh& surface, double voxel_m);

}  // namespace fourdvt::track

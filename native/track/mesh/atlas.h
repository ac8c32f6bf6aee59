// SPDX-License-Identifier: Apache-2.0
// UV atlas of a closed mesh, such as a person. Every chart is a topological disk. A vertex has one texture vertex in a
// chart, or two where a seam runs inside it, e.g. along a limb. The result depends on the input only, not on threads or
// the clock.
#pragma once

#include <span>

#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::track {

struct AtlasOptions {
  int texels = 1024;       // side of the texture
  int gutter_texels = 10;  // least distance between charts; half of it from a chart to the texture's border
};

// Cuts the mesh into charts, flattens and packs them. `resolution`: [vertex] relative texels per metre wanted, > 0, of
// which the most and the least wanted differ by 3 at most in the result; empty: even. `hidden`: [vertex] 0 … 1, 1 where
// seams are least visible; empty: equal. Fails with MeshTopology for a mesh that is open or not a manifold, with
// InvalidArgument for another length or value of `resolution` or `hidden`, or where the gutters leave no room.
Result<MeshTopology> unwrapped(const TriangleMesh& mesh, std::span<const float> resolution,
                               std::span<const float> hidden, const AtlasOptions& options);

struct AtlasQuality {
  uint32_t charts = 0;
  // L2 and L∞ texture stretch (Pedro V. Sander, John Snyder, Steven J. Gortler, Hugues Hoppe: Texture Mapping
  // Progressive Meshes. SIGGRAPH, 2001), each chart scaled to the area of its surface, so that 1 is isometric and a
  // wanted difference of resolution does not count.
  double stretch_l2 = 0, stretch_max = 0;
  double packed_share = 0;          // area of the faces in the texture
  uint32_t flipped_faces = 0;       // mirrored in the texture, or without area there
  uint32_t overlapping_texels = 0;  // with a centre inside two faces or more
  double seam_m = 0;                // length of the seams on the surface, each counted once
};

AtlasQuality atlasQuality(const MeshTopology& topology, const Positions& positions, int texels);

}  // namespace fourdvt::track

// SPDX-License-Identifier: Apache-2.0
// Two tangents per vertex of the base mesh, and how a displacement along them moves texture coordinates. Bake and
// player compute the same frames, so that a displacement of two numbers per vertex needs no pose.
#pragma once

#include <span>
#include <vector>

#include "base/mesh.h"

namespace fourdvt {

struct SurfaceFrames {
  // [vertex] two orthonormal vectors of the base pose, perpendicular to its normal; right-handed with it.
  std::vector<glm::mat2x3> tangents;
  // [3 * face + corner] texture coordinates per metre along the vertex's tangents. Averaged over the chart's faces
  // round the vertex, so that the texture stays continuous inside a chart. Zero where a face has no area.
  std::vector<glm::mat2> uv_from_tangents;
};

// `base`: vertex_count positions of the base mesh. A texture vertex must belong to one vertex, as in decoded base
// meshes.
SurfaceFrames computeSurfaceFrames(const MeshTopology& topology, std::span<const glm::vec3> base);

}  // namespace fourdvt

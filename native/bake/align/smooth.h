// SPDX-License-Identifier: Apache-2.0
// Third part of baked alignment: a smooth tangent field from certain and uncertain estimates (screened Laplacian on
// the base mesh, sparse Cholesky). Does NOT look at other frames: steadyAlignment does (steady.cpp).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "bake/align/lift.h"

namespace fourdvt::bake {

class TangentSmoother {
 public:
  // At smoothness 1, detail below about a centimetre is smoothed away where one frontal view is certain.
  static std::unique_ptr<TangentSmoother> create(const MeshTopology& topology, std::span<const glm::vec3> base,
                                                 const SurfaceFrames& frames, double smoothness);
  virtual ~TangentSmoother() = default;
  // Displacement per vertex along its tangents, metres. Minimises Σ area · (d − estimate)ᵀ information (d − estimate)
  // plus the field's unevenness under parallel transport. Vertices without information take the mean of their
  // neighbours; far from any information the field goes to 0.
  virtual std::vector<glm::vec2> solve(const std::vector<VertexEstimate>& estimates) = 0;
};

}  // namespace fourdvt::bake

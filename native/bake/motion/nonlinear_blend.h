// SPDX-License-Identifier: Apache-2.0
// The two blends of a class's meshes (algorithms/motion.md): linear by vertices, and non-linear by the faces'
// deformation gradients, which the corrections stored with a class approximate. hybrid_blend.h selects the
// corrections.
#pragma once

#include <memory>
#include <span>

#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::bake {

// Deformation-gradient blending: T = exp(Σ w log R) · Σ w S per face, solved for the vertices with a prefactorised
// sparse Cholesky decomposition (D. Casas, M. Tejera, J.-Y. Guillemaut, A. Hilton: Interactive Animation of 4D
// Performance Capture, IEEE Transactions on Visualization and Computer Graphics 19(5), 2013). Each connected part of
// the mesh is placed where the linear blend puts those of its faces that rotate least between the members: the linear
// blend is exact without rotation.
class NonlinearBlend {
 public:
  // `reference`: any pose of the mesh. Errors: MeshTopology (no face has an area, or nothing can be anchored).
  static Result<NonlinearBlend> create(const MeshTopology& topology, const Positions& reference);
  Positions blend(std::span<const Positions> members, std::span<const float> weights) const;

 private:
  class Solver;
  explicit NonlinearBlend(std::shared_ptr<const Solver> solver) : solver_(std::move(solver)) {}

  std::shared_ptr<const Solver> solver_;
};

Positions linearBlend(std::span<const Positions> members, std::span<const float> weights);

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Second part of baked alignment: turns the optical flow of one view, computed in both directions, into observations
// of the tangent displacement of the visible vertices; combines all views into one robust estimate per vertex, and
// these into a smooth field. Works frame by frame; steadyAlignment smooths over time.
#pragma once

#include <Eigen/SparseCholesky>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "bake/align/views.h"
#include "base/mesh.h"

namespace fourdvt::bake {

// One view's observation of one vertex: the residual displacement d satisfies
// pixels_from_tangents · d = flow, weighted by `certainty` (symmetric, eigenvalues 0..1; from facing,
// forward-backward agreement and texture in each direction).
struct FlowObservation {
  uint32_t vertex = 0;
  float pixels_per_metre = 0;
  glm::mat2 pixels_from_tangents{0};
  glm::mat2 certainty{0};
  glm::vec2 flow{0};  // pixels, from member 0's picture to the other's, y down
};

// Observes the flow between two CV_8U pictures of the same mesh, view and background; `interior` from interiorOf.
// Samples it half way between both pictures, where both will be shown on the mesh.
std::vector<FlowObservation> observeFlow(const cv::Mat& first, const cv::Mat& other, const cv::Mat& interior,
                                         const std::vector<SeenVertex>& seen);

// Normal equations of one vertex's displacement in base metres: information · d = pull. Information has no unit: 1 is
// one frontal view that is certain of both directions.
struct VertexEstimate {
  glm::mat2 information{0};
  glm::vec2 pull{0};
};

// Combines the views of each vertex by iterated Cauchy reweighting. `current`: the displacement with which the
// pictures were rendered, base metres. Estimates are of the whole displacement, including `current`.
std::vector<VertexEstimate> liftFlow(const std::vector<std::vector<FlowObservation>>& views,
                                     const std::vector<glm::vec2>& current);

// Solves for a smooth tangent field from estimates of varying certainty (screened Laplacian on the base mesh, sparse
// Cholesky).
class TangentSmoother {
 public:
  // At smoothness 1, detail below about a centimetre is smoothed away where one frontal view is certain.
  TangentSmoother(const MeshTopology& topology, std::span<const glm::vec3> base, const SurfaceFrames& frames,
                  double smoothness);
  // Displacement per vertex along its tangents, metres. Minimises Σ area · (d − estimate)ᵀ information (d − estimate)
  // plus the field's roughness under parallel transport. Vertices without information take the mean of their
  // neighbours; far from any information the field goes to 0.
  std::vector<glm::vec2> solve(const std::vector<VertexEstimate>& estimates);

 private:
  using Matrix = Eigen::SparseMatrix<double>;

  std::vector<double> areas_;  // [vertex]
  Matrix smooth_;              // roughness and the prior, without estimates
  Eigen::SimplicialLDLT<Matrix> solver_;
};

// Limits displacements of texture coordinates to the gutters of their charts.
class ChartLimits {
 public:
  // `size`: side of layer 1 in texels. Topology and frames are borrowed.
  ChartLimits(const MeshTopology& topology, const SurfaceFrames& frames, int size, int gutter_texels);
  // Shortens every displacement (metres along the tangents) that would move the texture coordinates of a corner,
  // forwards or backwards, beyond the gutter of their chart or into the gutter of another chart.
  void cut(std::vector<glm::vec2>& displacement_m) const;
  int size() const { return size_; }

 private:
  // Largest share of `shift` (texture coordinates) that stays within reach of the chart.
  float allowedShare(const glm::vec2& uv, const glm::vec2& shift, int chart) const;

  const MeshTopology* topology_;
  const SurfaceFrames* frames_;
  int size_ = 0;
  std::vector<int> chart_of_uv_;
  std::vector<int> reach_;  // size × size: the nearest chart within reach; kNoChart: none
};

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Second part of baked alignment: turns the optical flow of one view, computed in both directions, into observations of
// the tangent displacement of the vertices seen there; then combines all views into one robust estimate per vertex.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "bake/align/views.h"

namespace fourdvt::bake {

// One view's observation of one vertex: the displacement d that is still missing satisfies
// pixels_from_tangents · d = flow, weighted by `certainty` (symmetric, eigenvalues 0..1; from facing, forward-backward
// agreement and texture in each direction).
struct FlowObservation {
  uint32_t vertex = 0;
  float pixels_per_metre = 0;
  glm::mat2 pixels_from_tangents{0};
  glm::mat2 certainty{0};
  glm::vec2 flow{0};  // pixels, from member 0's look to the other's, y down
};

// first, other: CV_8U looks on the same mesh, view and background; `interior` as interiorOf gives. Flow is read half
// way between both looks, so that it belongs to the place on the mesh where both will be shown.
std::vector<FlowObservation> observeFlow(const cv::Mat& first, const cv::Mat& other, const cv::Mat& interior,
                                         const std::vector<SeenVertex>& seen);

// Normal equations of one vertex's displacement in base metres: information · d = pull. Information has no unit: 1 is
// one frontal view that is certain of both directions.
struct VertexEstimate {
  glm::mat2 information{0};
  glm::vec2 pull{0};
};

// Combines the views of each vertex by Cauchy reweighting. `current`: the displacement with which the looks were drawn,
// base metres. The estimates are of the whole displacement, not of what is missing from `current`.
std::vector<VertexEstimate> liftFlow(const std::vector<std::vector<FlowObservation>>& views,
                                     const std::vector<glm::vec2>& current);

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Second stage of baked alignment: flow both ways in one view → what it says about the tangent displacement of the
// vertices seen there; then one robust estimate a vertex from all views.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "bake/align/views.h"

namespace fourdvt::bake {

// Of one vertex in one view: the displacement d that is missing obeys pixels_from_tangents · d = flow, as far as
// `certainty` (symmetric, eigenvalues 0..1: facing, forward-backward agreement, texture in each direction) says.
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

// Normal equations of one vertex's displacement in base metres: information · d = pull. information is without unit: 1
// is one frontal view that is sure of both directions.
struct VertexEstimate {
  glm::mat2 information{0};
  glm::vec2 pull{0};
};

// Cauchy reweighting over the views of a vertex. `current`: displacement under which the looks were drawn, base metres;
// the estimates are of the whole displacement.
std::vector<VertexEstimate> liftFlow(const std::vector<std::vector<FlowObservation>>& views,
                                     const std::vector<glm::vec2>& current);

}  // namespace fourdvt::bake

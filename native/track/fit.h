// SPDX-License-Identifier: Apache-2.0
// Fits the template to one frame: its surface, and optical flow from frames that are fitted already.
#pragma once

#include <span>
#include <vector>

#include "base/mesh.h"
#include "track/graph.h"
#include "track/mesh/nearest.h"
#include "track/views.h"

namespace fourdvt::track {

struct Template {
  MeshTopology topology;
  Positions positions;  // in its own frame, world, metres
  DeformationGraph graph;
  std::vector<glm::vec3> node_positions;
  std::vector<glm::uvec2> edges;
};
Template makeTemplate(MeshTopology topology, Positions positions, uint32_t node_count);

// Template in a frame's pose.
struct FittedFrame {
  GraphPose pose;
  std::vector<glm::dvec3> offsets;  // [vertex] added to the template's positions before the pose, metres
  Positions positions;
};
FittedFrame restFrame(const Template& model);

struct FitOptions {
  bool flow_from_parent = true, flow_from_anchor = true;
  double surface_sigma_m = 0.004;
  double rigidity_sigma_m = 0.004;    // deviation of a link between nodes from a rotation
  double smoothness_sigma_m = 0.001;  // difference of neighbours' offsets
  double offset_sigma_m = 0.010;
};

// A frame to fit to.
struct TargetFrame {
  const TriangleMesh* surface = nullptr;
  const NearestSurface* nearest = nullptr;
  const std::vector<View>* views = nullptr;
};

// Fits from the pose of `parent`. `anchor`: frame whose appearance is kept, the template's; its positions may be those
// of `parent`.
FittedFrame fitFrame(const Template& model, const FittedFrame& start, const PosedViews& parent,
                     const PosedViews& anchor, const TargetFrame& target, const FitOptions& options);

}  // namespace fourdvt::track

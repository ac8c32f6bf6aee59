// SPDX-License-Identifier: Apache-2.0
// Fits the template to one frame: its surface, and optical flow from frames that are fitted already.
#pragma once

#include <span>
#include <vector>

#include "base/mesh.h"
#include "refine/outline.h"
#include "track/graph.h"
#include "track/limbs.h"
#include "track/mesh/nearest.h"
#include "track/views.h"

namespace fourdvt::track {

// Mesh that is fitted to every frame, with its graph.
struct Template {
  MeshTopology topology;
  Positions positions;  // in its own frame, world, metres
  DeformationGraph graph;
  std::vector<glm::vec3> node_positions;
  std::vector<glm::uvec2> edges;
  std::vector<refine::InnerEdge> inner_edges;
  std::vector<Limb> limbs;
};
// `surface`: that of the template's own frame, for the limbs.
Template makeTemplate(MeshTopology topology, Positions positions, uint32_t node_count, const TriangleMesh& surface);

// Template in a frame's pose.
struct FittedFrame {
  GraphPose pose;
  std::vector<glm::dvec3> offsets;  // [vertex] added to the template's positions before the pose, metres
  Positions positions;
};
// The template as it is: no rotation, no offset.
FittedFrame restFrame(const Template& model);

struct FitOptions {
  bool flow_from_parent = true, flow_from_anchor = true;
  // After lost parts: limbs are moved first, surfaces farther away count, and lead rather than flow.
  bool wide = false;
  double surface_sigma_m = 0.004;     // noise of the surface along its normals
  double rigidity_sigma_m = 0.016;    // deviation of a link between nodes from a rotation
  double smoothness_sigma_m = 0.002;  // difference of neighbours' offsets
  double offset_sigma_m = 0.010;      // size of the offsets themselves
  double outline_sigma_px = 0.5;      // noise of a matte's edge, per sample of the template's outline; 0: none
};

// A frame to fit to.
struct TargetFrame {
  const TriangleMesh* surface = nullptr;
  const NearestSurface* nearest = nullptr;
  const std::vector<View>* views = nullptr;
};

// Fits the template to `target`, beginning at `start`. Flow leads from `parent`, a similar frame that is fitted
// already, then from `anchor`, the template's own frame, so that a vertex keeps its appearance; from there on the
// parent counts where the anchor has no match.
FittedFrame fitFrame(const Template& model, const FittedFrame& start, const PosedViews& parent,
                     const PosedViews& anchor, const TargetFrame& target, const FitOptions& options);

// Positions of the template with its outlines on the mattes of its own frame, `target`: a polygon inscribed in a round
// limb is too thin.
Positions refined(const Template& model, const TargetFrame& target, const FitOptions& options);

}  // namespace fourdvt::track

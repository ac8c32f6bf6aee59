// SPDX-License-Identifier: Apache-2.0
// Figures of a fitted frame, from which failed fits are found.
#pragma once

#include <cstdint>
#include <vector>

#include "track/fit.h"

namespace fourdvt::track {

// Agreement of a mesh with the mattes of its frame.
struct Overlap {
  double mean = 0, lowest = 1;  // intersection over union, over the cameras that see enough
  uint32_t lowest_camera = 0;
};
Overlap overlapWith(const std::vector<glm::uvec3>& faces, const Positions& positions, const std::vector<View>& views);

struct FitFigures {
  Overlap overlap;
  // Distances between the template and the frame's surface, both ways, where cameras see them.
  double distance_95_m = 0, distance_max_m = 0;
  double lost_share = 0;                 // share of these distances over 30 mm, such as those of a lost hand
  glm::vec3 farthest{0};                 // place with distance_max_m, world
  double seen_share = 0;                 // share of the template's area that a camera sees
  uint32_t stretched_faces = 0;          // an edge over 2 times as long or below half as long as in the template
  uint32_t flipped_faces = 0;            // normal turned by over 90 degrees against its vertices' rotations
  std::vector<float> vertex_distance_m;  // [vertex] from the surface; negative: no camera sees it
  double colour_error = 0;  // mean difference of vertices' grey from the anchor's in the same camera, 0 … 255
};

// `anchor`: the template's own frame.
FitFigures figuresOf(const Template& model, const FittedFrame& fitted, const PosedViews& anchor,
                     const TargetFrame& target);

// One number for a fit, smaller is better: each part is about 1 for a usual one.
inline double misfit(const FitFigures& f) {
  return (1 - f.overlap.mean) / 0.02 + f.distance_95_m / 0.010 + f.lost_share / 0.02 + f.colour_error / 20;
}
inline constexpr double kMaxMisfit = 4;  // more: parts of the body lie elsewhere

}  // namespace fourdvt::track

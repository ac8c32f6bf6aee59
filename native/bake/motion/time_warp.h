// SPDX-License-Identifier: Apache-2.0
// Time-aligns two motions (algorithms/motion.md) by monotone dynamic time warping on pose and velocity. Loops are
// aligned cyclically: any frame of one may match frame 0 of the other.
#pragma once

#include <cstdint>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::bake {

// `count` vertices that lie far from each other (farthest points); all if there are fewer.
std::vector<uint32_t> spreadVertices(const Positions& positions, size_t count);

// [frame][value]: positions of the selected vertices minus their mean over the ground, then velocities per pass,
// scaled so that squared distances sum to pose distance + kPassVelocityWeight * velocity distance.
using PoseFeatures = std::vector<std::vector<float>>;
// frames: [frame] the chosen vertices' positions.
PoseFeatures poseFeatures(const std::vector<Positions>& frames, bool loop);

struct WarpSearch {
  size_t max_cells =
      size_t(1) << 24;     // phases times steps, 8 bytes each; larger grids are searched in a band of this size
  double band_frames = 2;  // half the first band's width, frames of the thinned member; above 0
};
// [phase], one per frame of `reference`: the frame of `member` at that time, fractional and strictly increasing, at a
// third to three times the mean pace. A loop may begin anywhere and passes its end once, counting modulo. Other
// motions start and end together. Above search.max_cells the search is coarse to fine: thinned motions are warped,
// then all phases in a band round that path. The band is widened up to this size while the path touches its edge.
std::vector<double> warpTime(const PoseFeatures& reference, const PoseFeatures& member, bool loop,
                             const WarpSearch& search = {});

}  // namespace fourdvt::bake

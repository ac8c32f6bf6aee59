// SPDX-License-Identifier: Apache-2.0
// Brings two motions to common time (ALGORITHMS 4.1) by monotone dynamic time warping on pose and velocity. Loops are
// aligned cyclically: any frame of the one may meet frame 0 of the other. Does NOT read meshes.
#pragma once

#include <cstdint>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::bake {

// `count` vertices that lie far from each other (farthest points); all if there are fewer.
std::vector<uint32_t> spreadVertices(const Positions& positions, size_t count);

// [frame][value]: positions of the chosen vertices less their mean over the ground, then velocities per pass, scaled so
// that squared distances add up to pose distance + kPassVelocityWeight * velocity distance.
using PoseFeatures = std::vector<std::vector<float>>;
// frames: [frame] the chosen vertices' positions.
PoseFeatures poseFeatures(const std::vector<Positions>& frames, bool loop);

// [phase], one per frame of `reference`: the frame of `member` at that time, fractional and strictly increasing, at a
// third to three times the mean pace. A loop may begin anywhere and passes its end once, counting modulo. Other motions
// start and end together.
std::vector<double> warpTime(const PoseFeatures& reference, const PoseFeatures& member, bool loop);

}  // namespace fourdvt::bake

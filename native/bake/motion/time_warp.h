// SPDX-License-Identifier: Apache-2.0
// Common time of two motions (ALGORITHMS 4.1): monotone dynamic time warping on pose and velocity. Loops are aligned
// cyclically: any frame of the one may meet frame 0 of the other. Does NOT read meshes.
#pragma once

#include <cstdint>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::bake {

// `count` vertices far from each other (farthest points), or all.
std::vector<uint32_t> spreadVertices(const Positions& positions, size_t count);

// [frame][value]: positions of the chosen vertices less their mean over the ground, then velocities per pass, scaled so
// that squared distances add up to pose distance + kPassVelocityWeight * velocity distance.
using PoseFeatures = std::vector<std::vector<float>>;
// frames: [frame] the chosen vertices' positions.
PoseFeatures poseFeatures(const std::vector<Positions>& frames, bool loop);

// [phase], one a frame of `reference`: where `member` is then, in its frames; strictly increasing, between a third and
// three times the mean pace. A loop's may begin anywhere and passes its end once: modulo. Others join first frames and
// last frames.
std::vector<double> warpTime(const PoseFeatures& reference, const PoseFeatures& member, bool loop);

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Depth maps against each other: what no other one confirms is not trusted.
#pragma once

#include <span>

#include "reconstruct/stereo/depth_map.h"

namespace fourdvt::reconstruct {

// Depth of the map at a pixel of its camera; 0 where unknown or outside.
float depthAt(const DepthMap& map, double x, double y);

// Multiplies the weights with the squared cosine between the surface and the ray: what a camera sees edge-on it
// measures badly.
void weighByAngle(DepthMap& map);

// Sets depths to 0 that another map looks through, or that none confirms to `tolerance_m`. A whole map loses weight the
// more of its depths others refute: from none where few are, to all where it is as many as by chance.
void keepConsistent(std::span<DepthMap> maps, double tolerance_m);

}  // namespace fourdvt::reconstruct

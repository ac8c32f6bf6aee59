// SPDX-License-Identifier: Apache-2.0
// How far a matte's edge lies from the edge that the picture itself shows. Does NOT need the mesh.
#pragma once

#include <vector>

#include "base/image.h"

namespace fourdvt::refine {

// For every place on the matte's edge where figure and background differ clearly in colour: how many pixels the matte's
// edge lies outside the picture's (negative: the matte is too small). `rgba`: alpha = matte. The figure's colour is
// taken from 4 to 7 pixels inside, the background's from as far outside, and the picture's edge is where linear light
// is half of each. Every `stride`-th pixel of the edge.
std::vector<double> matteEdgeOffsets(const Image& rgba, int stride);

}  // namespace fourdvt::refine

// SPDX-License-Identifier: Apache-2.0
// Leaves out points of rings, so that no ring comes to cross itself or another.
#pragma once

#include "reconstruct/contour.h"

namespace fourdvt::reconstruct {

double signedArea_px2(const Ring& ring);  // > 0: the inside has cross(q - p, x - p) > 0 along its edges

// Leaves out points in the order of the distance that this moves the ring, as long as no given point lies farther than
// `tolerance_px` from the edge that replaces it. A point stays where the triangle that it spans with its neighbours
// holds another point: without it, edges would cross. Every ring keeps three points.
void simplifyRings(std::vector<Ring>& rings, double tolerance_px);

}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
// Which wedges of two cameras can meet. The half planes from the line through both centres sort the viewing lines of
// both cameras by angle; two wedges meet only where their angles overlap.
#pragma once

#include <functional>

#include "reconstruct/hull_planes.h"

namespace fourdvt::reconstruct {

// Calls `visit` with the planes of every pair that may meet within the bounds: first one of camera `first`, then one of
// camera `second`. Each pair once. Stops when `visit` returns false.
void visitEpipolarPairs(const HullPlanes& planes, int first, int second,
                        const std::function<bool(uint32_t, uint32_t)>& visit);

}  // namespace fourdvt::reconstruct

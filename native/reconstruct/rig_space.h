// SPDX-License-Identifier: Apache-2.0
// The space that the cameras of a rig look at: the bounds within which silhouettes carve. Does NOT look at pictures.
#pragma once

#include <span>

#include "base/camera.h"

namespace fourdvt::reconstruct {

// The point that lies closest to the rays through the middle of all pictures, metres.
glm::dvec3 middleOf(std::span<const PinholeCamera> cameras);
// The largest distance from the middle at which the performer may be; grows with the rig.
double reachOf(std::span<const PinholeCamera> cameras, const glm::dvec3& middle);
// True if at least so many cameras see the sphere or part of it.
bool isSeen(std::span<const PinholeCamera> cameras, size_t least_cameras, const glm::dvec3& centre, double radius);

// Volume that more than half of the cameras see, m³, to within a few percent: all that silhouettes which cover the
// pictures would leave. 0: there is none.
double seenVolume(std::span<const PinholeCamera> cameras);

}  // namespace fourdvt::reconstruct

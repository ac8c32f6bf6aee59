// SPDX-License-Identifier: Apache-2.0
// Scale of a surface relative to a person, for lengths tuned to persons.
#pragma once

#include <vector>

#include "base/mesh.h"

namespace fourdvt {

// Longest side of the points' bounding box, metres. Requires at least one point.
double longestSide(const Positions& positions);

// World metres per metre of a scene scaled to the size of a person: a power of two, so that scaling lengths is exact
// and changes rarely; 1 if the median of the frames' longest sides is 1.42 to 2.82 m, or if no side is above 0.
double lengthScale(std::vector<double> longest_sides_m);

}  // namespace fourdvt

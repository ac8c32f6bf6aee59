// SPDX-License-Identifier: Apache-2.0
// The size of a surface against a person's, for lengths that suit a person.
#pragma once

#include <vector>

#include "base/mesh.h"

namespace fourdvt {

// The longest side of the points' box, metres. At least one point.
double longestSide(const Positions& positions);

// Metres of the world per metre of a scene in which the surface has a person's size: a power of two, so that lengths
// are multiplied exactly and change rarely; 1 where the median of the frames' longest sides is 1.42 to 2.82 m, or where
// there is none above 0.
double lengthScale(std::vector<double> longest_sides_m);

}  // namespace fourdvt

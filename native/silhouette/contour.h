// SPDX-License-Identifier: Apache-2.0
// Outlines of a silhouette as polygons (Li et al. 2003, section 4).
//
// Space outside a camera's picture is not carved. Hence rings bound the visible background: background at the picture's
// border is closed by an edge, foreground there is not. The coverage is used as given, except for specks, which are
// removed.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "base/image.h"

namespace fourdvt::silhouette {

// Closed ring of at least three points, pixels (centres at + 0.5); the last point connects to the first.
using Ring = std::vector<glm::dvec2>;

// Disjoint simple rings. Points inside by the even-odd rule are visible background; all others may hold the performer.
// Along every edge from p to q the background has cross(q - p, x - p) > 0: with y down, it lies on the right. Without
// rings nothing is carved.
struct Outline {
  std::vector<Ring> rings;
};

struct OutlineRules {
  double tolerance_px = 1;  // maximum distance of the iso-contour from the ring; 0: all points stay
  double min_area_px2 = 4;  // minimum area of a ring, of performer or background; smaller ones are removed as specks
  // Points lie on multiples of 1 / steps_per_px (even, at least 4); 0: unrestricted. Rounding precedes simplification,
  // which keeps rings disjoint; rounding afterwards would not.
  int steps_per_px = 0;
};

// Extracts and simplifies the iso-contour of `coverage` (1 channel: 0 background … 255 performer) at level 127.5 within
// the tolerance. Points stay where removal would make rings cross. Returns no rings for an empty picture.
Outline outlineOf(const Image& coverage, const OutlineRules& rules = {});

double signedArea_px2(const Ring& ring);  // > 0: the inside has cross(q - p, x - p) > 0 along the edges

// Removes points in order of the distance between ring and point while every input point stays within `tolerance_px` of
// the edge that replaces it. Rings stay simple and disjoint: a point stays where the triangle with its neighbours
// contains another point. Every ring keeps at least three points.
void simplifyRings(std::vector<Ring>& rings, double tolerance_px);

}  // namespace fourdvt::silhouette

// SPDX-License-Identifier: Apache-2.0
// The outline of a silhouette as polygons (OVH03, section 4).
//
// A pixel outside a camera's picture carves nothing, so what is outlined is the background that the camera sees: where
// background meets the picture's border there is an edge, where the performer meets it there is none. Does NOT judge
// or repair the coverage beyond leaving out specks.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "base/image.h"

namespace fourdvt::silhouette {

// A closed ring of at least three points, pixels (centres at + 0.5), the last joined to the first.
using Ring = std::vector<glm::dvec2>;

// Rings that do not touch each other or themselves. By even-odd rule the points inside are seen background; all others
// may hold the performer. Along every edge from p to q the background has cross(q - p, x - p) > 0: in the picture, with
// y down, it lies on the right. No rings: nothing is carved.
struct Outline {
  std::vector<Ring> rings;
};

struct OutlineRules {
  double tolerance_px = 1;  // no point of the iso-contour lies farther than this from the ring; 0: all points stay
  double min_area_px2 = 4;  // rings round less than this are specks and left out, whether performer or background
  // Points lie on multiples of 1 / this; 0: anywhere. Even, at least 4. It is done before points are left out, which
  // keeps rings apart; rounding them afterwards would not.
  int steps_per_px = 0;
};

// The iso-contour of `coverage` (1 channel: 0 background … 255 performer) at level 127.5, with as few points as the
// tolerance allows. Points stay where leaving them out would make rings cross. An empty picture has no rings.
Outline outlineOf(const Image& coverage, const OutlineRules& rules = {});

double signedArea_px2(const Ring& ring);  // > 0: the inside has cross(q - p, x - p) > 0 along its edges

// Leaves out points in the order of the distance that this moves the ring, as long as no given point lies farther than
// `tolerance_px` from the edge that replaces it. No ring comes to cross itself or another: a point stays where the
// triangle that it spans with its neighbours holds another point: without it, edges would cross. Every ring keeps three
// points.
void simplifyRings(std::vector<Ring>& rings, double tolerance_px);

}  // namespace fourdvt::silhouette

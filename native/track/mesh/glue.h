// SPDX-License-Identifier: Apache-2.0
// Glues small charts to larger ones along their longest and most visible common seams, as long as the result lies flat.
// A disk glued to a disk along one arc is a disk; so every chart is one, and a limb may be a chart with one seam along
// it.
#pragma once

#include "track/mesh/patch.h"

namespace fourdvt::track {

struct GlueLimits {
  double stretch_max = 1.6, stretch_l2 = 1.03;  // limits of a chart, as in AtlasQuality
  double area_share = 0.08;                     // largest share of the surface in one chart
  double resolution_ratio = 1.5;                // between the means of two charts
  double gap_m = 0;                             // least distance between places of a border that are not neighbours
};

// Returns flattened disks that together hold every face once; each within the limits or a single face.
std::vector<Patch> gluedCharts(const Surface& surface, std::vector<FaceSet> sets, const GlueLimits& limits);

}  // namespace fourdvt::track

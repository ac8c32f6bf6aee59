// SPDX-License-Identifier: Apache-2.0
// Offsets of a mesh along its vertex normals, such that its outlines come to lie on the mattes'. Does NOT look at
// pictures: outline.h does.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "refine/clearance.h"
#include "refine/outline.h"

namespace fourdvt::refine {

// Weights are relative to that of one point's squared misfit. Chosen on the sample capture's walk.
struct SurfaceFitOptions {
  double bound_m = 0.01;       // no vertex moves further
  double stiffness = 3;        // of (offset − neighbour's offset)²
  double keep = 0.2;           // of (offset − usual offset)²
  bool keep_at_median = true;  // the usual offset is the claims' median; else 0
};

// What one point says: the offset, in metres, that its edge still lacks.
struct OffsetClaim {
  uint32_t from = 0, to = 0;
  float to_share = 0;
  float offset_m = 0;
};
OffsetClaim claimOf(const OutlinePoint& point);

// [vertex] offsets that agree with most claims, smooth on the surface where there are few: least squares with Tukey's
// weights about their own scale. `current`: the offsets that the mesh has already; the result includes them. A claim
// that departs further than others do counts little, and one that lies beyond about five times the usual spread
// nothing. `clearances` are kept, whatever is claimed.
std::vector<float> fitOffsets(std::span<const OffsetClaim> claims, std::span<const InnerEdge> edges,
                              std::span<const float> current, std::span<const Clearance> clearances,
                              const SurfaceFitOptions& options);

}  // namespace fourdvt::refine

// SPDX-License-Identifier: Apache-2.0
// Offsets of a mesh along its vertex normals, such that its outlines come to lie on the mattes'. Does NOT look at
// pictures: outline.h does.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "base/mesh.h"
#include "refine/outline.h"

namespace fourdvt::refine {
// Keeps thin parts of a mesh, like a hem, from turning inside out as its vertices move along their normals. Does NOT
// look at pictures, and does NOT keep parts apart that come close from outside.

// Two sides of a thin part, which come towards each other as vertices move inwards: Σ share · offset (metres along the
// normals, shares at most 0) over these vertices must not exceed `most_m`.
struct Clearance {
  uint32_t place = 0;  // which of the mesh's, the same in all frames
  std::array<uint32_t, 6> vertices{};
  std::array<float, 6> shares{};
  float most_m = 0;  // a share of the thickness
};

// At up to four places within every face: where less than two times `bound_m` lies between two sides, and not inside
// another part of the mesh. `face_vertices`: welded, so that `normals` (unit) need be known only for vertices that
// faces name.
std::vector<Clearance> clearancesOf(std::span<const glm::uvec3> face_vertices, std::span<const glm::vec3> positions,
                                    std::span<const glm::vec3> normals, float bound_m);

// Of every place that has a clearance in more than half of the frames, the one in the middle: where a part only now and
// then touches another or folds in a joint, offsets that are constant in time stay free.
std::vector<Clearance> usualClearances(std::vector<Clearance> of_all_frames, size_t frames);

// The nearest offsets (least squares) that keep within the clearances, to about 10 µm. Source: Hildreth's method (H57).
void keepClear(std::span<const Clearance> clearances, std::span<float> offsets_m);

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

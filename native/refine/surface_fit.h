// SPDX-License-Identifier: Apache-2.0
// Fits offsets of a mesh along its vertex normals such that its outlines (outline.h) align with the mattes', and limits
// them so that thin parts, like a hem, do not turn inside out. Approaching parts are not separated from outside.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "base/mesh.h"
#include "refine/outline.h"

namespace fourdvt::refine {
// Limit for two sides of a thin part, which approach each other as vertices move inwards: Σ share · offset (metres
// along the normals, shares at most 0) over these vertices must not exceed `max_m`.
struct Clearance {
  uint32_t place = 0;  // index of the sample on the mesh, the same in all frames
  std::array<uint32_t, 6> vertices{};
  std::array<float, 6> shares{};
  float max_m = 0;  // share of the thickness
};

// Samples up to four points per face; returns a clearance where two sides are less than 2 · `bound_m` apart, except
// inside another part of the mesh. `face_vertices`: welded, so that `normals` (unit) are required only for vertices
// used by faces.
std::vector<Clearance> clearancesOf(std::span<const glm::uvec3> face_vertices, std::span<const glm::vec3> positions,
                                    std::span<const glm::vec3> normals, float bound_m);

// Median clearance of each sample that has one in more than half of the frames. Offsets, which are constant in time,
// stay free where parts touch or fold only in some frames.
std::vector<Clearance> usualClearances(std::vector<Clearance> of_all_frames, size_t frames);

// Nearest offsets (least squares) within the clearances, to about 10 µm. Source: Clifford Hildreth: A Quadratic
// Programming Procedure. Naval Research Logistics Quarterly 4(1), 1957.
void keepClear(std::span<const Clearance> clearances, std::span<float> offsets_m);

// Weights are relative to one point's squared residual. Tuned on the sample capture's walk.
struct SurfaceFitOptions {
  double bound_m = 0.01;       // maximum offset
  double stiffness = 3;        // weight of (offset − neighbour's offset)²
  double keep = 0.2;           // weight of (offset − usual offset)²
  bool keep_at_median = true;  // usual offset: median of the constraints; else 0
};

// Offset constraint by one outline point: the remaining offset of its edge, metres.
struct OffsetClaim {
  uint32_t from = 0, to = 0;
  float to_share = 0;
  float offset_m = 0;
};
OffsetClaim claimOf(const OutlinePoint& point);

// [vertex] offsets that fit the constraints, smooth on the surface where there are few: least squares with Tukey's
// weights by the robust scale of the residuals. `current`: present offsets of the mesh; the result includes them.
// Outliers get little weight, none beyond about five times the scale. `clearances` hold in any case.
std::vector<float> fitOffsets(std::span<const OffsetClaim> claims, std::span<const InnerEdge> edges,
                              std::span<const float> current, std::span<const Clearance> clearances,
                              const SurfaceFitOptions& options);

}  // namespace fourdvt::refine

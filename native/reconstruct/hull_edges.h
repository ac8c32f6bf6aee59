// SPDX-License-Identifier: Apache-2.0
// Edges and faces of a polyhedral visual hull: the segments of plane intersections inside all silhouettes (viewing
// edges, and cone intersection edges between triple points), linked to loops per plane and triangulated.
//
// Source: Jean-Sébastien Franco, Edmond Boyer: Efficient Polyhedral Modeling from Silhouettes. IEEE Transactions on
// Pattern Analysis and Machine Intelligence 31(3), 2009.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "reconstruct/hull_planes.h"

namespace fourdvt::reconstruct {
// Name of a vertex: its three planes, ascending; independent of how it was found.
using VertexName = uint64_t;
constexpr int kPlaneBits = 21;
inline VertexName vertexName(uint32_t a, uint32_t b, uint32_t c) {
  if (a > b) std::swap(a, b);
  if (b > c) std::swap(b, c);
  if (a > b) std::swap(a, b);
  return (VertexName(a) << (2 * kPlaneBits)) | (VertexName(b) << kPlaneBits) | c;
}
inline std::array<uint32_t, 3> planesOf(VertexName name) {
  constexpr uint32_t kMask = (1u << kPlaneBits) - 1;
  return {uint32_t(name >> (2 * kPlaneBits)) & kMask, uint32_t(name >> kPlaneBits) & kMask, uint32_t(name) & kMask};
}

// Directed edge on the border of the face in `plane`; seen from outside, the face lies on its left.
struct HalfEdge {
  uint32_t plane = 0;
  VertexName from = 0, to = 0;
};

// Computes two half edges per edge; none for degenerate planes or inconsistent predicates: another rounding of the
// planes may succeed.
std::optional<std::vector<HalfEdge>> hullEdges(const HullPlanes& planes, std::span<const SilhouetteCone> cones);

// Links half edges to a closed mesh with triangulated faces. Error Internal where they form none: each vertex must end
// three edges, two per adjacent face. `edges`: sorted by plane on return.
Result<TriangleMesh> hullFaces(const HullPlanes& planes, std::vector<HalfEdge>& edges);

// Row index of one camera's wedges, for queries by points and lines.
class SilhouetteLookup {
 public:
  SilhouetteLookup(const HullPlanes& planes, int camera, const PinholeCamera& pinhole);  // borrows the planes

  // True if the point lies inside the silhouette. Exact for outlines with edges at least 0.01 pixels apart. `scaled`:
  // the point's position. `tie` is set if PlanePoint::side() returns 0.
  bool mayHold(const PlanePoint& point, const glm::dvec3& scaled, bool& tie) const;

  // Appends the planes of wedges that may intersect the segment between two scaled points, each once.
  void candidates(const glm::dvec3& from, const glm::dvec3& to, std::vector<uint32_t>& found);

 private:
  int row(double y_px) const;
  bool mayHoldNear(uint32_t edge, const glm::dvec2& pixel, const PlanePoint& point, bool& tie) const;

  const HullPlanes& planes_;
  uint32_t first_;                  // the camera's first plane
  glm::dmat4 picture_from_scaled_;  // homogeneous pixels; the third entry is the scaled depth
  double top_px_ = 0, bottom_px_ = 0, row_px_ = 1;
  struct RowEdge {
    double left_px, right_px;  // whole edge
    uint32_t plane;
  };
  std::vector<std::vector<RowEdge>> rows_;  // [row] planes whose edges meet it
  std::vector<uint32_t> stamp_;             // [wedge] last query that found it
  uint32_t question_ = 0;
};

}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
// The edges of a polyhedral visual hull: the pieces of lines, in which two of its planes meet, that every camera lets
// the performer reach (FB09: viewing edges, and the cone intersection edges between triple points). Does NOT link them
// to faces.
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
// The three planes that meet in a vertex, ascending: its name, whichever way it was found.
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

// An edge as the border of the face in `plane`, which lies on its left seen from outside.
struct HalfEdge {
  uint32_t plane = 0;
  VertexName from = 0, to = 0;
};

// Two half edges for every edge; nothing if planes meet in one point, or cameras contradict themselves: other
// roundings of the planes may help.
std::optional<std::vector<HalfEdge>> hullEdges(const HullPlanes& planes, std::span<const SilhouetteCone> cones);

// Faces for the edges of a polyhedral visual hull: loops in every plane, and triangles between their vertices.

// A closed mesh, or Internal where the half edges do not make one: each vertex must end three edges, two of every face
// that it lies on. `edges`: sorted by plane on return.
Result<TriangleMesh> hullFaces(const HullPlanes& planes, std::vector<HalfEdge>& edges);

// Finds the wedges of one camera near points and lines of space, by rows of its picture.

class SilhouetteLookup {
 public:
  SilhouetteLookup(const HullPlanes& planes, int camera, const PinholeCamera& pinhole);  // borrows the planes

  // Whether the camera lets the performer be there. Exact for outlines whose edges keep a hundredth of a pixel apart.
  // `scaled`: the point's position; 0 of PlanePoint::side() sets `tie`.
  bool mayHold(const PlanePoint& point, const glm::dvec3& scaled, bool& tie) const;

  // Appends the planes whose wedges the straight line from one scaled point to another may pass, each once.
  void candidates(const glm::dvec3& from, const glm::dvec3& to, std::vector<uint32_t>& found);

 private:
  int row(double y_px) const;
  bool mayHoldNear(uint32_t edge, const glm::dvec2& pixel, const PlanePoint& point, bool& tie) const;

  const HullPlanes& planes_;
  uint32_t first_;                  // the camera's first plane
  glm::dmat4 picture_from_scaled_;  // homogeneous pixels; the third entry is the depth, scaled
  double top_px_ = 0, bottom_px_ = 0, row_px_ = 1;
  struct RowEdge {
    double left_px, right_px;  // of the whole edge
    uint32_t plane;
  };
  std::vector<std::vector<RowEdge>> rows_;  // planes whose edges meet the row
  std::vector<uint32_t> stamp_;             // per wedge: the last question that found it
  uint32_t question_ = 0;
};

}  // namespace fourdvt::reconstruct

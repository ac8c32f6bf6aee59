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

}  // namespace fourdvt::reconstruct

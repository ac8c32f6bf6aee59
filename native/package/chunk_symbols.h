// SPDX-License-Identifier: Apache-2.0
// What encoder and decoder of GOP chunks share. Internal to package/.
//
// Measured on the sample (4,005 vertices, 8,000 faces, 0.25 mm; bytes a frame, walk / pickup):
//   positions, first-order temporal + difference along the vertex order   7,101 / 6,779
//   positions, second-order temporal + difference (chosen)                6,697 / 6,390
//   the same with one attribute per coordinate                            6,995 / 6,821
//   labels (approximate, 19 % of faces change), one symbol per slot       3,610 / 3,439
//   labels, one symbol per face over a palette of label tuples            1,988 / 1,947
//   labels, the same plus "as the previous face" (chosen)                 1,781 / 1,787
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace fourdvt::package {

constexpr int32_t kSameAsPreviousFrame = 0;  // this face's tuple one frame earlier
constexpr int32_t kSameAsPreviousFace = 1;   // the tuple of face i-1 in this frame
constexpr int32_t kFirstRank = 2;            // 2 + rank in the palette

// Constant velocity: frame 0 from nothing, frame 1 from frame 0, later 2 p[f-1] - p[f-2]. Modulo 2^32.
inline glm::uvec3 predictedPosition(const glm::ivec3* positions, uint32_t frame, size_t vertex, size_t vertex_count) {
  if (frame == 0) return glm::uvec3(0);
  const glm::uvec3 previous(positions[(frame - 1) * vertex_count + vertex]);
  if (frame == 1) return previous;
  return 2u * previous - glm::uvec3(positions[(frame - 2) * vertex_count + vertex]);
}

}  // namespace fourdvt::package

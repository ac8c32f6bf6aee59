// SPDX-License-Identifier: Apache-2.0
// Base-mesh data of the GOP chunk coders: neighbouring faces, the order of vertices from coarse to fine, and a start
// pose. Built once per character. Exact definition: FORMAT.md, "Order of vertices".
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "package/base_mesh.h"

namespace fourdvt::package {

constexpr uint32_t kNoFace = UINT32_MAX;

struct ChunkMesh {
  std::vector<std::array<uint32_t, 3>> face_neighbours;  // [face][edge k, k+1]; kNoFace at a border
  std::vector<glm::ivec3> base;         // [vertex] base pose on a lattice; its longest side spans 0…16383
  std::vector<uint32_t> order;          // vertices as positions and fields are coded: coarse to fine
  std::vector<uint8_t> last_round;      // [vertex] 1: of the finest round, from which few others are predicted
  std::vector<uint32_t> earlier;        // see earlierOf
  std::vector<uint32_t> earlier_first;  // [vertex], and the end
  std::vector<uint8_t> ring_count;      // [vertex], see earlierOf

  uint32_t faceCount() const { return static_cast<uint32_t>(face_neighbours.size()); }
  uint32_t vertexCount() const { return static_cast<uint32_t>(base.size()); }
  // At most 10 vertices that precede `vertex` in `order`, nearest first, counted in edges; the first ring_count[vertex]
  // of them are equally near.
  std::span<const uint32_t> earlierOf(uint32_t vertex) const {
    return std::span(earlier).subspan(earlier_first[vertex], earlier_first[vertex + 1] - earlier_first[vertex]);
  }
};

// Builds from a base mesh in time and memory linear in the counts, for any topology.
ChunkMesh makeChunkMesh(const BaseMesh& mesh);
// Builds from any faces; base: [vertex] as ChunkMesh::base, at any scale.
ChunkMesh makeChunkMesh(const std::vector<glm::uvec3>& faces, std::vector<glm::ivec3> base);

}  // namespace fourdvt::package

// SPDX-License-Identifier: Apache-2.0
// Small meshes for the chunk coders, built without Draco, so that any number of vertices and faces is possible.
#pragma once

#include <cmath>

#include "package/chunk_counts.h"
#include "package/chunk_mesh.h"
#include "package/stream_file.h"

namespace fourdvt::testing {

// Mesh of these counts: faces follow the vertices as a strip, repeatedly if there are many faces (then some edges have
// more than two); with few faces, some vertices remain unused.
inline package::ChunkMesh strandMesh(uint32_t vertices, uint32_t faces) {
  package::BaseMesh mesh;
  mesh.topology.vertex_count = vertices;
  for (uint32_t v = 0; v < vertices; ++v) mesh.positions.emplace_back(0.1f * (v / 2), 0.2f * (v % 2), 0.01f * (v % 5));
  for (uint32_t f = 0; f < faces; ++f)
    mesh.topology.face_vertices.emplace_back(f % vertices, (f + 1) % vertices, (f + 2) % vertices);
  return package::makeChunkMesh(mesh);
}

// A cylinder of `around` by `along` quads, two faces each, in depth-first order along bands.
inline package::BaseMesh cylinder(uint32_t around, uint32_t along) {
  package::BaseMesh mesh;
  for (uint32_t j = 0; j <= along; ++j) {
    for (uint32_t i = 0; i < around; ++i) {
      const float angle = 6.2831853f * i / around;
      mesh.positions.emplace_back(0.3f * std::cos(angle), 1.7f * j / along, 0.3f * std::sin(angle));
    }
  }
  mesh.topology.vertex_count = static_cast<uint32_t>(mesh.positions.size());
  for (uint32_t j = 0; j < along; ++j) {
    for (uint32_t i = 0; i < around; ++i) {
      const uint32_t a = j * around + i, b = j * around + (i + 1) % around;
      mesh.topology.face_vertices.emplace_back(a, b, a + around);
      mesh.topology.face_vertices.emplace_back(b, b + around, a + around);
    }
  }
  return mesh;
}

inline package::StreamIndex indexFor(const package::ChunkFrames& f) {
  package::StreamIndex index;
  index.frame_count = f.frame_count;
  package::copyCounts(f, index);
  index.position_step_m = 1;
  index.alignment_step_m = 1;
  index.chunks = {{0, f.frame_count, 100, 100}};
  return index;
}

// Fills what a chunk's encoder requires besides the counts: zeros everywhere, no labels.
inline void fillWithZeros(package::ChunkFrames& f) {
  const size_t vertices = size_t(f.frame_count) * f.vertex_count;
  f.positions.resize(vertices * f.member_count);
  f.labels.resize(size_t(f.frame_count) * f.member_count * f.layer_count * f.face_count, 255);
  f.offsets.resize(vertices * f.reference_count);
  f.alignment.resize(vertices * f.alignment_count);
  f.root.resize(size_t(f.frame_count) * f.member_count);
}

inline bool sameChunk(const package::ChunkFrames& a, const package::ChunkFrames& b) {
  return a.positions == b.positions && a.labels == b.labels && a.offsets == b.offsets && a.alignment == b.alignment &&
         a.root == b.root;
}

}  // namespace fourdvt::testing

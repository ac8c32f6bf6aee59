// SPDX-License-Identifier: Apache-2.0
// Offsets of a capture's mesh along its vertex normals, which correct a surface that was reconstructed too large or too
// small. readMeshFrame adds them, so that all readers of meshes get the corrected surface.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::capture {

// Deviations from the constant offsets at some frames of a sequence, linearly interpolated.
struct SlowOffsets {
  std::vector<uint32_t> frames;              // ascending, not empty
  std::vector<std::vector<float>> offset_m;  // [frame of the list][vertex]
  uint32_t loop_frames = 0;                  // length of a loop, whose last frame precedes the first; 0: no loop
};

struct SurfaceOffsets {
  std::vector<uint32_t> same_as;            // [vertex] first vertex at the same position; these move as one
  std::vector<float> constant_m;            // [vertex] outwards, metres
  std::map<std::string, SlowOffsets> slow;  // by sequence; sequences without deviations are missing
};

// [vertex] first vertex at exactly the same position. Meshes cut along their texture's seams repeat positions.
std::vector<uint32_t> weldedVertices(const Positions& positions);
// Faces between welded vertices.
std::vector<glm::uvec3> weldedFaces(const MeshTopology& topology, const std::vector<uint32_t>& same_as);

// [vertex] offset at a frame of a sequence.
std::vector<float> offsetsAt(const SurfaceOffsets& offsets, const std::string& sequence, uint32_t frame);
// Moves the vertices along the normals of the mesh as given.
void addOffsets(const SurfaceOffsets& offsets, const MeshTopology& topology, const std::vector<float>& offset_m,
                Positions& positions);

}  // namespace fourdvt::capture

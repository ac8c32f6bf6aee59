// SPDX-License-Identifier: Apache-2.0
// Offsets of a capture's mesh along its vertex normals, which correct a surface that was reconstructed too large or too
// small. readMeshFrame adds them, so that whoever reads meshes sees the corrected surface. Does NOT say where offsets
// come from.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::capture {

// Departures from the constant offsets at some frames of a sequence, linear in between.
struct SlowOffsets {
  std::vector<uint32_t> frames;              // ascending, not empty
  std::vector<std::vector<float>> offset_m;  // [frame of the list][vertex]
  uint32_t loop_frames = 0;                  // length of a loop, whose last frame leads to the first; 0: no loop
};

struct SurfaceOffsets {
  std::vector<uint32_t> same_as;            // [vertex] the first vertex at the same place: both move as one
  std::vector<float> constant_m;            // [vertex] outwards, metres
  std::map<std::string, SlowOffsets> slow;  // by sequence; those without are not in it
};

// [vertex] the first vertex at exactly the same place. Meshes that are cut along their texture's seams have several.
std::vector<uint32_t> weldedVertices(const Positions& positions);
// The faces between welded vertices.
std::vector<glm::uvec3> weldedFaces(const MeshTopology& topology, const std::vector<uint32_t>& same_as);

// [vertex] the offset at a frame of a sequence.
std::vector<float> offsetsAt(const SurfaceOffsets& offsets, const std::string& sequence, uint32_t frame);
// Moves the vertices along the normals of the mesh as given.
void addOffsets(const SurfaceOffsets& offsets, const MeshTopology& topology, const std::vector<float>& offset_m,
                Positions& positions);

}  // namespace fourdvt::capture

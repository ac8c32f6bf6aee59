// SPDX-License-Identifier: Apache-2.0
// The base mesh: topology, UVs and one pose, Draco edgebreaker. Its decoded order of vertices and faces is THE order
// of every stream of the character: the writer re-indexes to it, the reader decodes into it.
#pragma once

#include <span>

#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::package {

struct BaseMesh {
  MeshTopology topology;  // vertex = Draco's unique position value, uv = Draco point
  Positions positions;    // quantised pose stored with the mesh
};

struct EncodedBaseMesh {
  std::vector<uint8_t> bytes;                    // Draco, as KHR_draco_mesh_compression wants it
  std::vector<uint32_t> source_vertex;           // decoded vertex → source vertex (non-manifold vertices may repeat)
  std::vector<uint32_t> source_face;             // decoded face → source face; corner order may be rotated
  BaseMesh decoded;                              // what decodeBaseMesh(bytes) gives
  int position_attribute = 0, uv_attribute = 0;  // Draco unique ids for the glTF extension; uv -1: none
  int colour_attribute = -1;                     // likewise, of colours of vertices; -1: none
  uint32_t point_count = 0;                      // glTF accessor count (unique position/uv pairs)
  BoundingBox point_bounds;                      // of the decoded positions, exact: glTF accessor min/max
};

// position_bits/uv_bits: Draco quantisation. Errors: Internal.
Result<EncodedBaseMesh> encodeBaseMesh(const MeshTopology& topology, const Positions& positions, int position_bits = 14,
                                       int uv_bits = 13);
// A surface without UVs, for glTF viewers: uv_attribute is -1, the source orders are empty. linear_colours: RGB of each
// vertex, 65535 = 1; without any, the mesh has no colours. Errors: Internal.
Result<EncodedBaseMesh> encodePlainMesh(const TriangleMesh& surface, std::span<const glm::u16vec3> linear_colours = {},
                                        int position_bits = 14);
constexpr uint32_t kMaxFaces = 1u << 22;
// Errors: MeshDataInvalid. `max_faces`: what the manifest says; more are refused before Draco allocates for them.
Result<BaseMesh> decodeBaseMesh(std::span<const uint8_t> bytes, uint32_t max_faces = kMaxFaces);

}  // namespace fourdvt::package

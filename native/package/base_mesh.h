// SPDX-License-Identifier: Apache-2.0
// Base mesh: topology, UVs and one pose, Draco edgebreaker. Every stream of the character uses its decoded order of
// vertices and faces: the writer re-indexes to it, the reader decodes into it.
#pragma once

#include <span>

#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::package {

struct BaseMesh {
  MeshTopology topology;  // vertex = Draco's unique position value, uv = Draco point
  Positions positions;    // quantised pose
};

struct EncodedBaseMesh {
  std::vector<uint8_t> bytes;                    // Draco, conforming to KHR_draco_mesh_compression
  std::vector<uint32_t> source_vertex;           // decoded vertex → source vertex (non-manifold vertices may repeat)
  std::vector<uint32_t> source_face;             // decoded face → source face; corner order may be rotated
  BaseMesh decoded;                              // result of decodeBaseMesh(bytes)
  int position_attribute = 0, uv_attribute = 0;  // Draco unique ids for the glTF extension; uv -1: none
  int colour_attribute = -1;                     // Draco unique id of vertex colours; -1: none
  uint32_t point_count = 0;                      // glTF accessor count (unique position/uv pairs)
  BoundingBox point_bounds;                      // exact bounds of the decoded positions: glTF accessor min/max
};

// position_bits, uv_bits: Draco quantisation. Errors: Internal.
Result<EncodedBaseMesh> encodeBaseMesh(const MeshTopology& topology, const Positions& positions, int position_bits = 14,
                                       int uv_bits = 13);
// Encodes a surface without UVs for glTF viewers: uv_attribute is -1, the source orders are empty. linear_colours: RGB
// per vertex, 65535 = 1; empty: no colours. Errors: Internal.
Result<EncodedBaseMesh> encodePlainMesh(const TriangleMesh& surface, std::span<const glm::u16vec3> linear_colours = {},
                                        int position_bits = 14);
constexpr uint32_t kMaxFaces = 1u << 22;
// max_faces: the manifest's count; more are refused before Draco allocates. Errors: MeshDataInvalid.
Result<BaseMesh> decodeBaseMesh(std::span<const uint8_t> bytes, uint32_t max_faces = kMaxFaces);

}  // namespace fourdvt::package

// SPDX-License-Identifier: Apache-2.0
// Two passes: edgebreaker with per-corner identifiers yields the decoded order of vertices and faces; the second pass
// encodes without identifiers and must decode in the same order.
#include <algorithm>
#include <cmath>
#include <map>

#include "draco/compression/expert_encode.h"
#include "package/base_mesh_draco.h"

namespace fourdvt::package {
namespace {

using draco::AttributeValueIndex;
using draco::GeometryAttribute;
using draco::PointIndex;

constexpr double kMaxUvErrorTexels = 0.1, kTexelsPerUv = 1024;
constexpr int kMaxUvBits = 20;

struct Quantisation {
  int position = 14, uv = 13;  // quantisation bits
};

Error meshFailed(const std::string& what) { return {ErrorId::Internal, "base mesh: " + what}; }

template <class Vec>
int addFloats(draco::Mesh& mesh, GeometryAttribute::Type type, const std::vector<Vec>& values) {
  GeometryAttribute attribute;
  constexpr int kComponents = sizeof(Vec) / sizeof(float);
  attribute.Init(type, nullptr, kComponents, draco::DT_FLOAT32, false, sizeof(Vec), 0);
  const int id = mesh.AddAttribute(attribute, false, static_cast<uint32_t>(values.size()));
  for (uint32_t i = 0; i < values.size(); ++i)
    mesh.attribute(id)->SetAttributeValue(AttributeValueIndex(i), &values[i][0]);
  return id;
}

// Draco point of every corner: one point per unique (vertex, uv) pair, or one per corner.
std::vector<uint32_t> cornerPoints(const MeshTopology& topology, bool one_per_corner, uint32_t& point_count) {
  std::vector<uint32_t> points;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> known;
  for (uint32_t f = 0; f < topology.faceCount(); ++f) {
    for (int c = 0; c < 3; ++c) {
      const auto key = std::make_pair(topology.face_vertices[f][c], topology.face_uvs[f][c]);
      const uint32_t next = static_cast<uint32_t>(one_per_corner ? points.size() : known.size());
      points.push_back(one_per_corner ? next : known.emplace(key, next).first->second);
    }
  }
  point_count = static_cast<uint32_t>(one_per_corner ? points.size() : known.size());
  return points;
}

// with_ids: adds a generic int32 attribute holding 3 * face + corner.
draco::Mesh* buildMesh(draco::Mesh& mesh, const MeshTopology& topology, const Positions& positions, bool with_ids) {
  uint32_t point_count = 0;
  const std::vector<uint32_t> points = cornerPoints(topology, with_ids, point_count);
  mesh.set_num_points(point_count);
  mesh.SetNumFaces(topology.faceCount());
  const int position_id = addFloats(mesh, GeometryAttribute::POSITION, positions);
  const int uv_id = addFloats(mesh, GeometryAttribute::TEX_COORD, topology.uvs);
  mesh.attribute(position_id)->SetExplicitMapping(point_count);
  mesh.attribute(uv_id)->SetExplicitMapping(point_count);
  if (with_ids) {
    GeometryAttribute ids;
    ids.Init(GeometryAttribute::GENERIC, nullptr, 1, draco::DT_INT32, false, sizeof(int32_t), 0);
    const int id = mesh.AddAttribute(ids, true, point_count);
    for (uint32_t i = 0; i < point_count; ++i) {
      const int32_t value = static_cast<int32_t>(i);
      mesh.attribute(id)->SetAttributeValue(AttributeValueIndex(i), &value);
    }
  }
  for (uint32_t f = 0; f < topology.faceCount(); ++f) {
    draco::Mesh::Face face;
    for (int c = 0; c < 3; ++c) {
      face[c] = PointIndex(points[3 * f + c]);
      mesh.attribute(position_id)->SetPointMapEntry(face[c], AttributeValueIndex(topology.face_vertices[f][c]));
      mesh.attribute(uv_id)->SetPointMapEntry(face[c], AttributeValueIndex(topology.face_uvs[f][c]));
    }
    mesh.SetFace(draco::FaceIndex(f), face);
  }
  return &mesh;
}

Result<std::vector<uint8_t>> encode(const draco::Mesh& mesh, const Quantisation& bits) {
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetSpeedOptions(3, 3);
  encoder.SetAttributeQuantization(0, bits.position);
  encoder.SetAttributeQuantization(1, bits.uv);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodeToBuffer(&buffer);
  if (!status.ok()) return meshFailed("Draco: " + status.error_msg_string());
  return std::vector<uint8_t>(buffer.data(), buffer.data() + buffer.size());
}

// Fills source_vertex and source_face from the identifiers of pass 1.
Status readOrder(const draco::Mesh& mesh, const BaseMesh& base, const MeshTopology& source, EncodedBaseMesh& out) {
  const auto* ids = mesh.GetNamedAttribute(GeometryAttribute::GENERIC);
  if (!ids || ids->data_type() != draco::DT_INT32) return meshFailed("identifiers were lost");
  out.source_vertex.assign(base.topology.vertex_count, UINT32_MAX);
  out.source_face.assign(base.topology.faceCount(), UINT32_MAX);
  for (uint32_t f = 0; f < base.topology.faceCount(); ++f) {
    for (int c = 0; c < 3; ++c) {
      int32_t corner = -1;
      ids->GetMappedValue(mesh.face(draco::FaceIndex(f))[c], &corner);
      if (corner < 0 || uint32_t(corner) >= 3 * source.faceCount()) return meshFailed("identifiers were damaged");
      const uint32_t source_face = uint32_t(corner) / 3;
      if (c > 0 && out.source_face[f] != source_face) return meshFailed("a face mixes corners of two source faces");
      out.source_face[f] = source_face;
      uint32_t& vertex = out.source_vertex[base.topology.face_vertices[f][c]];
      const uint32_t source_vertex = source.face_vertices[source_face][uint32_t(corner) % 3];
      if (vertex != UINT32_MAX && vertex != source_vertex) return meshFailed("a vertex merges two source vertices");
      vertex = source_vertex;
    }
  }
  if (std::count(out.source_vertex.begin(), out.source_vertex.end(), UINT32_MAX))
    return meshFailed("a vertex has no face");
  return {};
}

// Source-face corner of a decoded corner; rotations keep the winding.
int sourceCorner(const EncodedBaseMesh& mesh, const MeshTopology& source, uint32_t face, int corner) {
  for (int turn = 0; turn < 3; ++turn) {
    bool same = true;
    for (int c = 0; c < 3 && same; ++c) {
      same = mesh.source_vertex[mesh.decoded.topology.face_vertices[face][c]] ==
             source.face_vertices[mesh.source_face[face]][(c + turn) % 3];
    }
    if (same) return (corner + turn) % 3;
  }
  return -1;
}

// Largest UV error in texels of a 1024² texture; negative if positions or faces differ from the source's.
double verify(const EncodedBaseMesh& mesh, const MeshTopology& source, const Positions& positions, int position_bits) {
  const float step = static_cast<float>(longestSide(positions)) / static_cast<float>((1 << position_bits) - 1);
  for (uint32_t v = 0; v < mesh.source_vertex.size(); ++v) {
    const glm::vec3 error = glm::abs(mesh.decoded.positions[v] - positions[mesh.source_vertex[v]]);
    if (std::max({error.x, error.y, error.z}) > 0.51f * step + 1e-6f) return -1;
  }
  double worst = 0;
  for (uint32_t f = 0; f < mesh.source_face.size(); ++f) {
    for (int c = 0; c < 3; ++c) {
      const int from = sourceCorner(mesh, source, f, c);
      if (from < 0) return -1;
      const glm::vec2 error = glm::abs(mesh.decoded.topology.uvs[mesh.decoded.topology.face_uvs[f][c]] -
                                       source.uvs[source.face_uvs[mesh.source_face[f]][from]]);
      worst = std::max({worst, error.x * kTexelsPerUv, error.y * kTexelsPerUv});
    }
  }
  return worst;
}

// Pass 2: final bytes, decoded back and compared with pass 1's order.
Status encodeFinal(const MeshTopology& topology, const Positions& positions, const BaseMesh& ordered,
                   const Quantisation& bits, EncodedBaseMesh& out) {
  draco::Mesh plain;
  FOURDVT_ASSIGN(out.bytes, encode(*buildMesh(plain, topology, positions, false), bits));
  const auto mesh = decodeDracoMesh(out.bytes);
  if (!mesh) return meshFailed("own bytes do not decode");
  FOURDVT_ASSIGN(out.decoded, baseMeshFromDraco(*mesh));
  if (out.decoded.topology.face_vertices != ordered.topology.face_vertices)
    return meshFailed("Draco changed the order");
  out.point_count = mesh->num_points();
  out.position_attribute = static_cast<int>(mesh->GetNamedAttribute(GeometryAttribute::POSITION)->unique_id());
  out.uv_attribute = static_cast<int>(mesh->GetNamedAttribute(GeometryAttribute::TEX_COORD)->unique_id());
  return {};
}

}  // namespace

Result<EncodedBaseMesh> encodeBaseMesh(const MeshTopology& topology, const Positions& positions, int position_bits,
                                       int uv_bits) {
  if (positions.size() != topology.vertex_count || topology.face_vertices.size() != topology.face_uvs.size()) {
    return meshFailed("positions or face UVs do not match the topology");
  }
  draco::Mesh with_ids;
  auto first = encode(*buildMesh(with_ids, topology, positions, true), {position_bits, uv_bits});
  if (!first) return first.error();
  const auto ordered_mesh = decodeDracoMesh(first.value());
  if (!ordered_mesh) return meshFailed("own bytes do not decode");
  auto ordered = baseMeshFromDraco(*ordered_mesh);
  if (!ordered) return ordered.error();
  EncodedBaseMesh out;
  FOURDVT_TRY(readOrder(*ordered_mesh, ordered.value(), topology, out));
  double uv_error = 0;
  do {
    FOURDVT_TRY(encodeFinal(topology, positions, ordered.value(), {position_bits, uv_bits}, out));
    uv_error = verify(out, topology, positions, position_bits);
    if (uv_error < 0) return meshFailed("decoded mesh differs from the source");
  } while (uv_error >= kMaxUvErrorTexels && ++uv_bits <= kMaxUvBits);
  if (uv_error >= kMaxUvErrorTexels) return meshFailed("texture coordinates cannot be quantised finely enough");
  out.point_bounds = boundsOf(out.decoded.positions);
  return out;
}

}  // namespace fourdvt::package

// SPDX-License-Identifier: Apache-2.0
#include "package/base_mesh.h"

#include <cmath>

#include "base/bytes.h"
#include "draco/compression/config/compression_shared.h"
#include "draco/compression/mesh/mesh_edgebreaker_decoder.h"
#include "package/base_mesh_draco.h"

namespace fourdvt::package {
namespace {

using draco::GeometryAttribute;

Error invalidMesh(const char* what) {
  return {ErrorId::MeshDataInvalid, std::string("base mesh: ") + what + "; the mesh file is damaged, upload it again"};
}

// Reads an attribute's values, Components floats each; false on a bad index or value.
template <class Vec>
bool attributeValues(const draco::PointAttribute& attribute, std::vector<Vec>& out) {
  constexpr int kComponents = sizeof(Vec) / sizeof(float);
  if (attribute.data_type() != draco::DT_FLOAT32 || attribute.num_components() != kComponents) return false;
  out.resize(attribute.size());
  for (uint32_t i = 0; i < out.size(); ++i) {
    attribute.GetValue(draco::AttributeValueIndex(i), &out[i][0]);
    for (int c = 0; c < kComponents; ++c) {
      if (!std::isfinite(out[i][c])) return false;
    }
  }
  return true;
}

}  // namespace

bool mappingInRange(const draco::PointAttribute& attribute, uint32_t point_count) {
  if (!attribute.is_mapping_identity() && attribute.indices_map_size() < point_count) return false;
  for (uint32_t p = 0; p < point_count; ++p) {
    if (attribute.mapped_index(draco::PointIndex(p)).value() >= attribute.size()) return false;
  }
  return true;
}

std::unique_ptr<draco::Mesh> decodeDracoMesh(std::span<const uint8_t> bytes, uint32_t max_faces) {
  if (!looksLikeMesh(bytes, max_faces)) return nullptr;
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  auto mesh = std::make_unique<draco::Mesh>();
  draco::MeshEdgebreakerDecoder decoder;  // only method that looksLikeMesh accepts
  return decoder.Decode({}, &buffer, mesh.get()).ok() ? std::move(mesh) : nullptr;
}

Result<BaseMesh> baseMeshFromDraco(const draco::Mesh& mesh) {
  const auto* position = mesh.GetNamedAttribute(GeometryAttribute::POSITION);
  const auto* uv = mesh.GetNamedAttribute(GeometryAttribute::TEX_COORD);
  if (!position || !uv) return invalidMesh("positions or texture coordinates are missing");
  const uint32_t points = mesh.num_points();
  if (!mappingInRange(*position, points) || !mappingInRange(*uv, points)) return invalidMesh("bad attribute mapping");
  BaseMesh out;
  std::vector<glm::vec2> uv_values;
  if (!attributeValues(*position, out.positions) || !attributeValues(*uv, uv_values)) return invalidMesh("bad values");
  MeshTopology& topology = out.topology;
  topology.vertex_count = static_cast<uint32_t>(out.positions.size());
  for (uint32_t p = 0; p < points; ++p)
    topology.uvs.push_back(uv_values[uv->mapped_index(draco::PointIndex(p)).value()]);
  for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
    glm::uvec3 face_points, face_vertices;
    for (int c = 0; c < 3; ++c) {
      const draco::PointIndex point = mesh.face(draco::FaceIndex(f))[c];
      if (point.value() >= points) return invalidMesh("face index out of range");
      face_points[c] = point.value();
      face_vertices[c] = position->mapped_index(point).value();
    }
    topology.face_uvs.push_back(face_points);
    topology.face_vertices.push_back(face_vertices);
  }
  if (topology.face_vertices.empty() || topology.vertex_count < 3) return invalidMesh("empty");
  return out;
}

Result<BaseMesh> decodeBaseMesh(std::span<const uint8_t> bytes, uint32_t max_faces) {
  const auto mesh = decodeDracoMesh(bytes, max_faces);
  if (!mesh) return invalidMesh("Draco cannot decode it, or it has other counts than the manifest says");
  return baseMeshFromDraco(*mesh);
}

namespace {

uint32_t varint(ByteReader& in) {
  uint32_t value = 0;
  for (int shift = 0; shift < 35; shift += 7) {
    const uint8_t byte = in.u8();
    value |= static_cast<uint32_t>(byte & 0x7f) << (shift < 32 ? shift : 31);
    if (!(byte & 0x80)) return value;
  }
  return UINT32_MAX;
}

// "DRACO", version, type, method, flags without metadata.
bool headerIs(ByteReader& in, uint8_t minor, uint8_t type, uint8_t method) {
  const auto magic = in.bytes(5);
  if (!in.ok() || std::memcmp(magic.data(), "DRACO", 5) != 0) return false;
  const bool version_ok = in.u8() == 2 && in.u8() == minor;
  const bool kind_ok = in.u8() == type && in.u8() == method;
  return version_ok && kind_ok && in.u16() == 0 && in.ok();
}

}  // namespace

bool looksLikeMesh(std::span<const uint8_t> bytes, uint32_t max_faces) {
  constexpr uint64_t kMaxFacesPerByte = 64;
  ByteReader in(bytes);
  if (!headerIs(in, draco::kDracoMeshBitstreamVersionMinor, draco::TRIANGULAR_MESH, draco::MESH_EDGEBREAKER_ENCODING)) {
    return false;
  }
  in.u8();  // traversal
  const uint32_t vertices = varint(in), faces = varint(in);
  const uint8_t attribute_tables = in.u8();
  const uint32_t symbols = varint(in), splits = varint(in);
  if (!in.ok() || vertices < 3 || faces < 1 || faces > max_faces) return false;
  return faces <= kMaxFacesPerByte * bytes.size() && vertices <= 3ull * faces && attribute_tables <= 8 &&
         symbols <= faces && splits <= symbols;
}

}  // namespace fourdvt::package

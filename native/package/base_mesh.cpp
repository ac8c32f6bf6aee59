// SPDX-License-Identifier: Apache-2.0
#include "package/base_mesh.h"

#include <cmath>

#include "draco/compression/mesh/mesh_edgebreaker_decoder.h"
#include "package/base_mesh_draco.h"
#include "package/draco_guard.h"

namespace fourdvt::package {
namespace {

using draco::GeometryAttribute;

Error invalidMesh(const char* what) {
  return {ErrorId::MeshDataInvalid, std::string("base mesh: ") + what + "; the mesh file is damaged, upload it again"};
}

// Float values of an attribute, Components each; false if an index or a value is bad.
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
  draco::MeshEdgebreakerDecoder decoder;  // the one method that looksLikeMesh lets through
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

}  // namespace fourdvt::package

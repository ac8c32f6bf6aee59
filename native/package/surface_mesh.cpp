// SPDX-License-Identifier: Apache-2.0
#include "package/surface_mesh.h"

#include "package/base_mesh_draco.h"
#include "package/residual_model.h"

namespace fourdvt::package {
namespace {

bool readPositions(const draco::PointAttribute& attribute, std::vector<glm::ivec3>& out) {
  out.resize(attribute.size());
  for (uint32_t i = 0; i < out.size(); ++i) {
    std::array<int32_t, 3> q;
    if (!attribute.GetValue<int32_t, 3>(draco::AttributeValueIndex(i), &q)) return false;
    out[i] = {q[0], q[1], q[2]};
    if (!inRange(out[i])) return false;
  }
  return true;
}

bool readFaces(const draco::Mesh& mesh, const draco::PointAttribute& positions, std::vector<glm::uvec3>& out) {
  out.reserve(mesh.num_faces());
  for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
    glm::uvec3& face = out.emplace_back();
    for (int c = 0; c < 3; ++c) {
      const draco::PointIndex point = mesh.face(draco::FaceIndex(f))[c];
      if (point.value() >= mesh.num_points()) return false;
      face[c] = positions.mapped_index(point).value();
    }
  }
  return true;
}

}  // namespace

std::optional<QuantisedSurface> decodeSurfaceMesh(std::span<const uint8_t> bytes, uint32_t max_vertices,
                                                  uint32_t max_faces) {
  const auto mesh = decodeDracoMesh(bytes, max_faces);
  if (!mesh || mesh->num_attributes() != 1 || mesh->num_faces() == 0 || mesh->num_faces() > max_faces) return {};
  const auto* positions = mesh->GetNamedAttribute(draco::GeometryAttribute::POSITION);
  if (!positions || positions->data_type() != draco::DT_INT32 || positions->num_components() != 3) return {};
  if (positions->size() > max_vertices || !mappingInRange(*positions, mesh->num_points())) return {};
  QuantisedSurface out;
  if (!readPositions(*positions, out.positions) || !readFaces(*mesh, *positions, out.faces)) return {};
  return out;
}

}  // namespace fourdvt::package

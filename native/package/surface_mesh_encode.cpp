// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "base/hash.h"
#include "draco/compression/expert_encode.h"
#include "package/base_mesh_draco.h"
#include "package/surface_mesh.h"

namespace fourdvt::package {
namespace {

using draco::AttributeValueIndex;
using draco::GeometryAttribute;

Error surfaceFailed(const std::string& what) { return {ErrorId::Internal, "surface: " + what}; }

// Adds an attribute with one point per vertex and `components` values per point. 16-bit values are shares of 65535.
int addAttribute(draco::Mesh& mesh, GeometryAttribute::Type type, draco::DataType data, int components,
                 const void* values) {
  const int64_t stride = int64_t(draco::DataTypeLength(data)) * components;
  GeometryAttribute attribute;
  attribute.Init(type, nullptr, static_cast<int8_t>(components), data, data == draco::DT_UINT16, stride, 0);
  const int id = mesh.AddAttribute(attribute, true, mesh.num_points());
  for (uint32_t i = 0; i < mesh.num_points(); ++i)
    mesh.attribute(id)->SetAttributeValue(AttributeValueIndex(i), static_cast<const uint8_t*>(values) + i * stride);
  return id;
}

void setFaces(draco::Mesh& mesh, size_t vertices, const std::vector<glm::uvec3>& faces) {
  mesh.set_num_points(static_cast<uint32_t>(vertices));
  mesh.SetNumFaces(faces.size());
  for (uint32_t f = 0; f < faces.size(); ++f) {
    draco::Mesh::Face face;
    for (int c = 0; c < 3; ++c) face[c] = draco::PointIndex(faces[f][c]);
    mesh.SetFace(draco::FaceIndex(f), face);
  }
}

// position_bits: quantisation of float positions; 0: integer positions.
Result<std::vector<uint8_t>> encode(const draco::Mesh& mesh, int position_bits) {
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetSpeedOptions(0, 0);  // the smallest bytes
  if (position_bits > 0) encoder.SetAttributeQuantization(0, position_bits);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodeToBuffer(&buffer);
  if (!status.ok()) return surfaceFailed("Draco: " + status.error_msg_string());
  return std::vector<uint8_t>(buffer.data(), buffer.data() + buffer.size());
}

// Order-independent hash: equal for surfaces that differ only in the order of vertices and faces.
uint64_t shapeOf(const QuantisedSurface& surface) {
  uint64_t sum = 0;
  for (const glm::uvec3& face : surface.faces) {
    std::array<glm::ivec3, 3> corners;
    for (int c = 0; c < 3; ++c) corners[c] = surface.positions[face[c]];
    for (int turn = 0; turn < 3; ++turn) {  // independent of the first corner
      sum += fnv1a({reinterpret_cast<const uint8_t*>(corners.data()), sizeof corners});
      std::rotate(corners.begin(), corners.begin() + 1, corners.end());
    }
  }
  return sum;
}

}  // namespace

Result<EncodedSurfaceMesh> encodeSurfaceMesh(const QuantisedSurface& surface) {
  draco::Mesh mesh;
  setFaces(mesh, surface.positions.size(), surface.faces);
  addAttribute(mesh, GeometryAttribute::POSITION, draco::DT_INT32, 3, surface.positions.data());
  EncodedSurfaceMesh out;
  FOURDVT_ASSIGN(out.bytes, encode(mesh, 0));
  auto decoded = decodeSurfaceMesh(out.bytes, UINT32_MAX, kMaxFaces);
  if (!decoded) return surfaceFailed("own bytes do not decode");
  out.decoded = std::move(*decoded);
  if (out.decoded.faces.size() != surface.faces.size() || shapeOf(out.decoded) != shapeOf(surface))
    return surfaceFailed("Draco changed the surface");
  return out;
}

// Encodes again with vertex numbers beside the positions; neither encoding moves a vertex.
Result<std::vector<uint32_t>> sourceVertices(const QuantisedSurface& surface, const QuantisedSurface& decoded) {
  draco::Mesh mesh;
  setFaces(mesh, surface.positions.size(), surface.faces);
  std::vector<int32_t> numbers(surface.positions.size());
  for (size_t v = 0; v < numbers.size(); ++v) numbers[v] = static_cast<int32_t>(v);
  addAttribute(mesh, GeometryAttribute::POSITION, draco::DT_INT32, 3, surface.positions.data());
  addAttribute(mesh, GeometryAttribute::GENERIC, draco::DT_INT32, 1, numbers.data());
  FOURDVT_ASSIGN(const auto bytes, encode(mesh, 0));
  const auto numbered = decodeDracoMesh(bytes);
  const auto* ids = numbered ? numbered->GetNamedAttribute(GeometryAttribute::GENERIC) : nullptr;
  const auto* positions = numbered ? numbered->GetNamedAttribute(GeometryAttribute::POSITION) : nullptr;
  if (!ids || !positions || numbered->num_faces() != decoded.faces.size())
    return surfaceFailed("own bytes do not decode");
  std::vector<uint32_t> source(decoded.positions.size(), UINT32_MAX);
  for (uint32_t f = 0; f < numbered->num_faces(); ++f) {
    for (int c = 0; c < 3; ++c) {
      const draco::PointIndex point = numbered->face(draco::FaceIndex(f))[c];
      if (positions->mapped_index(point).value() != decoded.faces[f][c])
        return surfaceFailed("Draco changed the order");
      int32_t number = -1;
      ids->GetMappedValue(point, &number);
      if (number < 0 || size_t(number) >= surface.positions.size())
        return surfaceFailed("a vertex's number was damaged");
      source[decoded.faces[f][c]] = static_cast<uint32_t>(number);
    }
  }
  if (std::count(source.begin(), source.end(), UINT32_MAX)) return surfaceFailed("a vertex has no face");
  return source;
}

Result<EncodedBaseMesh> encodePlainMesh(const TriangleMesh& surface, std::span<const glm::u16vec3> linear_colours,
                                        int position_bits) {
  draco::Mesh mesh;
  setFaces(mesh, surface.positions.size(), surface.faces);
  addAttribute(mesh, GeometryAttribute::POSITION, draco::DT_FLOAT32, 3, surface.positions.data());
  if (!linear_colours.empty()) {
    if (linear_colours.size() != surface.positions.size()) return surfaceFailed("not a colour for each vertex");
    addAttribute(mesh, GeometryAttribute::COLOR, draco::DT_UINT16, 3, linear_colours.data());
  }
  EncodedBaseMesh out;
  FOURDVT_ASSIGN(out.bytes, encode(mesh, position_bits));
  const auto decoded = decodeDracoMesh(out.bytes);
  const auto* positions = decoded ? decoded->GetNamedAttribute(GeometryAttribute::POSITION) : nullptr;
  if (!positions || positions->size() == 0) return surfaceFailed("own bytes do not decode");
  for (uint32_t i = 0; i < positions->size(); ++i)
    positions->GetValue(AttributeValueIndex(i), &out.decoded.positions.emplace_back()[0]);
  out.decoded.topology.vertex_count = static_cast<uint32_t>(out.decoded.positions.size());
  for (uint32_t f = 0; f < decoded->num_faces(); ++f) {
    glm::uvec3& face = out.decoded.topology.face_vertices.emplace_back();
    for (int c = 0; c < 3; ++c) face[c] = positions->mapped_index(decoded->face(draco::FaceIndex(f))[c]).value();
  }
  out.point_count = decoded->num_points();
  out.position_attribute = static_cast<int>(positions->unique_id());
  out.uv_attribute = -1;
  if (const auto* colours = decoded->GetNamedAttribute(GeometryAttribute::COLOR))
    out.colour_attribute = static_cast<int>(colours->unique_id());
  out.point_bounds = boundsOf(out.decoded.positions);
  return out;
}

}  // namespace fourdvt::package

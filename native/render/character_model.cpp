// SPDX-License-Identifier: Apache-2.0
#include "render/character_model.h"

#include <algorithm>
#include <cassert>

#include "base/mesh.h"
#include "render/shared_corners.h"
#include "render/table.h"

namespace fourdvt::render {
namespace {

constexpr uint32_t kEmptyLabel = 31;
constexpr int kLabelBits = 5;

std::vector<glm::vec4> cornerTable(const package::BaseMesh& mesh) {
  const MeshTopology& topology = mesh.topology;
  const SurfaceFrames frames = computeSurfaceFrames(topology, mesh.positions);
  std::vector<glm::vec4> table;
  resizeToRows(table, 6ull * topology.faceCount(), glm::vec4(0));
  for (uint32_t face = 0; face < topology.faceCount(); ++face)
    for (int corner = 0; corner < 3; ++corner) {
      const glm::vec2 uv = topology.uvs[topology.face_uvs[face][corner]];
      const glm::mat2& uv_from_tangents = frames.uv_from_tangents[3 * face + corner];
      glm::vec4* texels = &table[2 * (3 * face + corner)];
      texels[0] = {uv.x, uv.y, static_cast<float>(topology.face_vertices[face][corner]), 0};
      texels[1] = {uv_from_tangents[0], uv_from_tangents[1]};
    }
  return table;
}

Status checkSize(const gpu::Device& device, uint32_t vertices, uint32_t faces, uint64_t table_texels) {
  if (faces == 0) return Error{ErrorId::GpuFailure, "the character has no faces; bake it again"};
  if (vertices >= 1u << 24 || tableRows(table_texels) > static_cast<uint32_t>(device.caps().max_texture_size))
    return Error{ErrorId::GpuFailure, "the character's mesh is too large for this GPU: " + std::to_string(faces) +
                                          " faces; bake a coarser mesh"};
  return {};
}

Status checkMesh(const gpu::Device& device, const package::Character& character, const package::BaseMesh& mesh) {
  const uint32_t vertices = mesh.topology.vertex_count, faces = mesh.topology.faceCount();
  FOURDVT_TRY(checkSize(device, vertices, faces, layeredTableTexels(vertices, faces)));
  if (character.layer_count < 1 || character.layer_count > package::kMaxLayers ||
      character.cameras.size() > static_cast<size_t>(package::kMaxCameras))
    return Error{ErrorId::InvalidArgument, "layer or camera count of the character is out of range"};
  return {};
}

uint64_t nextSerial() {
  static uint64_t serial = 0;
  return ++serial;
}

}  // namespace

bool isClosedSurface(const std::vector<glm::uvec3>& faces) {
  std::vector<std::pair<uint32_t, uint32_t>> edges, opposite;
  for (const glm::uvec3& face : faces)
    for (int corner = 0; corner < 3; ++corner) {
      const uint32_t a = face[corner], b = face[(corner + 1) % 3];
      edges.emplace_back(a, b);
      opposite.emplace_back(b, a);
    }
  std::sort(edges.begin(), edges.end());
  std::sort(opposite.begin(), opposite.end());
  return edges == opposite && std::adjacent_find(edges.begin(), edges.end()) == edges.end();
}

void packLabels(const std::vector<glm::uvec3>& face_vertices, std::span<const uint8_t> labels, int camera_count,
                std::span<uint32_t> packed, std::span<uint32_t> masks) {
  const size_t face_count = face_vertices.size();
  for (size_t face = 0; face < face_count; ++face) {
    uint32_t cameras = 0;
    int shift = 0;
    for (size_t i = face; i < labels.size(); i += face_count, shift += kLabelBits) {
      const uint32_t label = labels[i];
      if (label >= static_cast<uint32_t>(camera_count)) continue;
      packed[face] ^= (kEmptyLabel ^ label) << shift;
      cameras |= 1u << label;
    }
    for (int corner = 0; corner < 3; ++corner) masks[face_vertices[face][corner]] &= cameras;
  }
}

CharacterModel CharacterModel::emptyModel(const package::Character& character) {
  CharacterModel model;
  model.layer_count = character.layer_count;
  model.camera_count = static_cast<int>(character.cameras.size());
  model.bounds = model.frame_bounds = character.bounds;
  model.ground_y_m = character.ground_y_m;
  model.length_scale = static_cast<float>(character.length_scale);
  model.sweep_band_m = static_cast<float>(character.method.sweep_band_m);
  for (const PinholeCamera& camera : character.cameras)
    model.camera_centres.emplace_back(glm::vec3(camera.centreInWorld()), 0);
  return model;
}

Result<CharacterModel> CharacterModel::create(gpu::Device& device, const package::Character& character,
                                              const package::BaseMesh& mesh) {
  FOURDVT_TRY(checkMesh(device, character, mesh));
  CharacterModel model = emptyModel(character);
  model.vertex_count = mesh.topology.vertex_count;
  model.face_count = mesh.topology.faceCount();
  model.face_vertices_ = mesh.topology.face_vertices;
  model.closed_surface = isClosedSurface(model.face_vertices_);
  FOURDVT_ASSIGN(model.corners, makeTable(device, gpu::PixelFormat::RGBA32F, 6ull * model.face_count, "corners"));
  FOURDVT_ASSIGN(model.positions_normals,
                 makeTable(device, gpu::PixelFormat::RGBA32F, 2ull * model.vertex_count, "positions and normals"));
  uploadTable(device, model.corners, cornerTable(mesh));
  model.corners_before_ = render::cornersBefore(mesh.topology.face_uvs, mesh.topology.uvs.size());
  const std::vector<uint32_t> casting =
      shadowCorners(model.face_vertices_, mesh.positions, float(model.ground_y_m), model.length_scale);
  model.shadow_corner_count = int(casting.size());
  if (casting.empty()) return model;
  model.shadow_corners = gpu::makeIndexBuffer(device);
  device.updateIndices(model.shadow_corners.id(), casting);
  return model;
}

Result<CharacterModel> CharacterModel::createForSurfaces(gpu::Device& device, const package::Character& character) {
  const uint32_t vertices = character.vertex_count, faces = character.face_count;
  FOURDVT_TRY(checkSize(device, vertices, faces, surfaceTableTexels(vertices, faces)));
  CharacterModel model = emptyModel(character);
  model.max_vertices_ = vertices;
  model.max_faces_ = faces;
  FOURDVT_ASSIGN(model.corner_vertices, makeTable(device, gpu::PixelFormat::R32UI, 3ull * faces, "corners' vertices"));
  FOURDVT_ASSIGN(model.positions_normals,
                 makeTable(device, gpu::PixelFormat::RGBA32F, 2ull * vertices, "positions and normals"));
  return model;
}

Status CharacterModel::setTopology(gpu::Device& device, std::span<const glm::uvec3> faces, uint32_t vertices) {
  if (faces.empty() || faces.size() > max_faces_ || vertices > max_vertices_)
    return Error{ErrorId::InvalidArgument, "the surface has no faces, or more than the character says"};
  face_vertices_.assign(faces.begin(), faces.end());
  vertex_count = vertices;
  face_count = static_cast<uint32_t>(faces.size());
  closed_surface = isClosedSurface(face_vertices_);
  resizeToRows(corner_table_, 3 * faces.size(), 0u);
  for (size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) corner_table_[3 * f + k] = faces[f][k];
  uploadTable(device, corner_vertices, corner_table_);
  topology_serial = nextSerial();
  return {};
}

void CharacterModel::setPositions(gpu::Device& device, std::span<const glm::vec3> positions) {
  assert(positions.size() == vertex_count);
  computeVertexNormals(face_vertices_, positions.data(), vertex_count, normals_);
  resizeToRows(table_, 2ull * vertex_count, glm::vec4(0));
  frame_bounds = {positions[0], positions[0]};
  for (uint32_t vertex = 0; vertex < vertex_count; ++vertex) {
    const glm::vec3& position = positions[vertex];
    table_[2 * vertex] = glm::vec4(position, 1);
    table_[2 * vertex + 1] = glm::vec4(normals_[vertex], 0);
    frame_bounds.min = glm::min(frame_bounds.min, position);
    frame_bounds.max = glm::max(frame_bounds.max, position);
  }
  uploadTable(device, positions_normals, table_);
  geometry_serial = nextSerial();
}

}  // namespace fourdvt::render

// SPDX-License-Identifier: Apache-2.0
#include "render/character_model.h"

#include <algorithm>
#include <cassert>

namespace fourdvt::render {
namespace {

constexpr uint32_t kEmptySlot = 31;
constexpr int kLabelBits = 5;

uint32_t tableRows(uint64_t texels) {
  return static_cast<uint32_t>(
      std::max<uint64_t>(1, (texels + CharacterModel::kTableWidth - 1) / CharacterModel::kTableWidth));
}

Result<gpu::Texture> makeTable(gpu::Device& device, gpu::PixelFormat format, uint64_t texels, const char* label) {
  return gpu::makeTexture(device, {.format = format,
                                   .width = CharacterModel::kTableWidth,
                                   .height = static_cast<int>(tableRows(texels)),
                                   .label = label});
}

// `table` holds whole rows.
template <class T>
void uploadTable(gpu::Device& device, const gpu::Texture& texture, const std::vector<T>& table) {
  const int rows = static_cast<int>(table.size() / CharacterModel::kTableWidth);
  device.updateTexture(texture.id(), 0, 0, 0, CharacterModel::kTableWidth, rows, table.data());
}

template <class T>
void resizeToRows(std::vector<T>& table, uint64_t texels, T fill) {
  table.assign(static_cast<size_t>(tableRows(texels)) * CharacterModel::kTableWidth, fill);
}

std::vector<glm::vec4> cornerTable(const MeshTopology& topology) {
  std::vector<glm::vec4> table;
  resizeToRows(table, 3ull * topology.faceCount(), glm::vec4(0));
  for (uint32_t face = 0; face < topology.faceCount(); ++face)
    for (int corner = 0; corner < 3; ++corner) {
      const glm::vec2 uv = topology.uvs[topology.face_uvs[face][corner]];
      table[3 * face + corner] = {uv.x, uv.y, static_cast<float>(topology.face_vertices[face][corner]), 0};
    }
  return table;
}

Status checkMesh(const gpu::Device& device, const package::Character& character, const package::BaseMesh& mesh) {
  const uint64_t corners = 3ull * mesh.topology.faceCount(), halves = 2ull * mesh.topology.vertex_count;
  if (corners == 0) return Error{ErrorId::GpuFailure, "the character has no faces; bake it again"};
  if (mesh.topology.vertex_count >= 1u << 24 ||
      tableRows(std::max(corners, halves)) > static_cast<uint32_t>(device.caps().max_texture_size))
    return Error{ErrorId::GpuFailure, "the character's mesh is too large for this GPU: " +
                                          std::to_string(mesh.topology.faceCount()) + " faces; bake a coarser mesh"};
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

Result<PictureTextures> createPicture(gpu::Device& device, int width, int height, PictureTextures::Kind kind) {
  PictureTextures picture;
  picture.kind = kind;
  const auto plane = [&](gpu::Texture& out, gpu::PixelFormat format, int w, int h, const char* label) -> Status {
    auto made = gpu::makeTexture(
        device, {.format = format, .width = w, .height = h, .filter = gpu::Filter::Linear, .label = label});
    if (!made) return made.error();
    out = made.take();
    return {};
  };
  if (kind == PictureTextures::Kind::Rgba) {
    FOURDVT_TRY(plane(picture.rgba, gpu::PixelFormat::RGBA8, width, height, "picture rgba"));
    return picture;
  }
  FOURDVT_TRY(plane(picture.y, gpu::PixelFormat::R8, width, height, "picture y"));
  FOURDVT_TRY(plane(picture.u, gpu::PixelFormat::R8, width / 2, height / 2, "picture u"));
  FOURDVT_TRY(plane(picture.v, gpu::PixelFormat::R8, width / 2, height / 2, "picture v"));
  return picture;
}

void uploadPicture(gpu::Device& device, PictureTextures& picture, const I420View& frame) {
  assert(picture.kind == PictureTextures::Kind::I420);
  const int half_width = frame.width / 2, half_height = frame.height / 2;
  device.updateTexture(picture.y.id(), 0, 0, 0, frame.width, frame.height, frame.y, frame.stride_y);
  device.updateTexture(picture.u.id(), 0, 0, 0, half_width, half_height, frame.u, frame.stride_u);
  device.updateTexture(picture.v.id(), 0, 0, 0, half_width, half_height, frame.v, frame.stride_v);
}

void packLabels(const std::vector<glm::uvec3>& face_vertices, std::span<const uint8_t> labels, int layer_count,
                int camera_count, std::vector<uint32_t>& packed, std::vector<uint32_t>& masks) {
  const size_t face_count = face_vertices.size();
  for (size_t face = 0; face < face_count; ++face) {
    uint32_t cameras = 0;
    for (int slot = 0; slot < layer_count; ++slot) {
      const uint32_t label = labels[slot * face_count + face];
      if (label >= static_cast<uint32_t>(camera_count)) continue;
      packed[face] ^= (kEmptySlot ^ label) << (kLabelBits * slot);
      cameras |= 1u << label;
    }
    for (int corner = 0; corner < 3; ++corner) masks[face_vertices[face][corner]] &= cameras;
  }
}

Result<CharacterModel> CharacterModel::create(gpu::Device& device, const package::Character& character,
                                              const package::BaseMesh& mesh) {
  FOURDVT_TRY(checkMesh(device, character, mesh));
  CharacterModel model;
  model.layer_count = character.layer_count;
  model.camera_count = static_cast<int>(character.cameras.size());
  model.vertex_count = mesh.topology.vertex_count;
  model.face_count = mesh.topology.faceCount();
  model.bounds = model.frame_bounds = character.bounds;
  model.ground_y_m = character.ground_y_m;
  model.face_vertices_ = mesh.topology.face_vertices;
  model.closed_surface = isClosedSurface(model.face_vertices_);
  for (const PinholeCamera& camera : character.cameras) {
    model.camera_centres.emplace_back(glm::vec3(camera.centreInWorld()), 0);
    model.camera_forwards.emplace_back(glm::vec3(camera.forwardInWorld()), 0);
  }
  struct Wanted {
    gpu::Texture* out;
    gpu::PixelFormat format;
    uint64_t texels;
    const char* label;
  };
  const Wanted tables[] = {
      {&model.corners, gpu::PixelFormat::RGBA32F, 3ull * model.face_count, "corners"},
      {&model.positions_normals, gpu::PixelFormat::RGBA32F, 2ull * model.vertex_count, "positions and normals"},
      {&model.vertex_masks, gpu::PixelFormat::R32UI, model.vertex_count, "vertex camera masks"},
      {&model.labels, gpu::PixelFormat::R32UI, model.face_count, "face labels"}};
  for (const Wanted& table : tables) {
    auto made = makeTable(device, table.format, table.texels, table.label);
    if (!made) return made.error();
    *table.out = made.take();
  }
  uploadTable(device, model.corners, cornerTable(mesh.topology));
  return model;
}

void CharacterModel::setGeometry(gpu::Device& device, const FrameGeometry& frame) {
  assert(frame.positions.size() == vertex_count);
  assert(frame.labels.size() == static_cast<size_t>(layer_count) * face_count);
  computeVertexNormals(face_vertices_, frame.positions.data(), vertex_count, normals_);
  resizeToRows(table_, 2ull * vertex_count, glm::vec4(0));
  frame_bounds = {frame.positions[0], frame.positions[0]};
  for (uint32_t vertex = 0; vertex < vertex_count; ++vertex) {
    const glm::vec3& position = frame.positions[vertex];
    table_[2 * vertex] = glm::vec4(position, 1);
    table_[2 * vertex + 1] = glm::vec4(normals_[vertex], 0);
    frame_bounds.min = glm::min(frame_bounds.min, position);
    frame_bounds.max = glm::max(frame_bounds.max, position);
  }
  resizeToRows(masks_, vertex_count, 0xffffffffu);
  resizeToRows(packed_, face_count, 0xffffffffu);
  packLabels(face_vertices_, frame.labels, layer_count, camera_count, packed_, masks_);
  uploadTable(device, positions_normals, table_);
  uploadTable(device, vertex_masks, masks_);
  uploadTable(device, labels, packed_);
  geometry_serial = nextSerial();
}

void CharacterModel::setLayout(const package::Rendition& rendition) {
  picture_size = {rendition.width, rendition.height};
  layer_rects_uv.clear();
  for (const package::Rect& rect : rendition.layers)
    layer_rects_uv.emplace_back(glm::vec2(rect.x, rect.y) / picture_size,
                                glm::vec2(rect.width, rect.height) / picture_size);
}

}  // namespace fourdvt::render

// SPDX-License-Identifier: Apache-2.0
#include "render/fields/surface_neighbours.h"

#include "render/table.h"

namespace fourdvt::render {

Status SurfaceNeighbours::update(gpu::Device& device, const CharacterModel& model) {
  if (model.vertex_count > vertices_ || model.face_count > faces_) {
    // The next surface is about as large.
    const auto room = [](uint32_t count, uint32_t most) { return std::max(count, std::min(count + count / 4, most)); };
    const uint32_t vertices = room(model.vertex_count, model.mostVertices()),
                   faces = room(model.face_count, model.mostFaces());
    vertices_ = faces_ = 0;
    is_filled_ = false;
    FOURDVT_ASSIGN(table_,
                   makeTable(device, gpu::PixelFormat::R32UI, vertices + 1 + 6ull * faces, "vertices' neighbours"));
    vertices_ = vertices;
    faces_ = faces;
  }
  if (is_filled_ && topology_serial_ == model.topology_serial) return {};
  const uint32_t vertices = model.vertex_count;
  resizeToRows(lists_, vertices + 1 + 6ull * model.face_count, 0u);
  for (const glm::uvec3& face : model.faces())
    for (int k = 0; k < 3; ++k) lists_[face[k]] += 2;
  uint32_t end = vertices + 1;
  for (uint32_t v = 0; v <= vertices; ++v) {
    const uint32_t count = v < vertices ? lists_[v] : 0;
    lists_[v] = end;
    end += count;
  }
  std::vector<uint32_t> next(lists_.begin(), lists_.begin() + vertices);
  for (const glm::uvec3& face : model.faces())
    for (int k = 0; k < 3; ++k) {
      lists_[next[face[k]]++] = face[(k + 1) % 3];
      lists_[next[face[k]]++] = face[(k + 2) % 3];
    }
  uploadTable(device, table_, lists_);
  topology_serial_ = model.topology_serial;
  is_filled_ = true;
  return {};
}

}  // namespace fourdvt::render

// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/unseen_fill.h"

#include <algorithm>
#include <string>

#include "render/table.h"

namespace fourdvt::render {

Status UnseenFill::makeTables(gpu::Device& device, const CharacterModel& model) {
  if (model.vertex_count <= table_vertices_) return {};
  // The next surface is about as large.
  const uint32_t vertices = std::min(model.vertex_count + model.vertex_count / 4, model.mostVertices());
  table_vertices_ = 0;
  for (Table* table : {&seen_, &colors_[0], &colors_[1]}) {
    *table = {};
    FOURDVT_ASSIGN(table->texture, makeTable(device, gpu::PixelFormat::RGBA8, vertices, "vertices' colours"));
    FOURDVT_ASSIGN(table->target,
                   gpu::makeTarget(device, {.colors = {table->texture.id()}, .label = "vertices' colours"}));
  }
  table_vertices_ = vertices;
  return {};
}

Status UnseenFill::update(gpu::Device& device, const CharacterModel& model, size_t camera_count,
                          const BlendPictures& pictures, const CameraUniforms& cameras) {
  FOURDVT_TRY(makeTables(device, model));
  FOURDVT_TRY(neighbours_.update(device, model));
  const std::string defines = CameraUniforms::defines(camera_count, pictures);
  gpu::Program& seen_program = seen_programs_[defines];
  if (!seen_program) {
    FOURDVT_ASSIGN(seen_program, makeCameraProgram(device, "camera_fullscreen.vert", "camera_fill_seen.frag", defines));
  }
  if (!spread_program_) {
    FOURDVT_ASSIGN(spread_program_, makeCameraProgram(device, "camera_fullscreen.vert", "camera_fill_spread.frag"));
  }
  const int vertex_count = static_cast<int>(model.vertex_count), rows = static_cast<int>(tableRows(model.vertex_count));
  const auto draw = [&](const Table& to, const gpu::Draw& what) {
    device.beginPass({.target = to.target.id(), .width = CharacterModel::kTableWidth, .height = rows, .label = "fill"});
    device.draw(what);
    device.endPass();
  };
  gpu::Draw seen{.program = seen_program.id(),
                 .textures = {{"u_positions_normals", model.positions_normals.id()}},
                 .uniforms = {gpu::uniform("u_vertex_count", vertex_count)},
                 .vertex_count = 3};
  cameras.addTo(seen);
  draw(seen_, seen);
  static_assert(kSteps % 2 == 0);  // the last step lands in the first table
  for (int step = 0; step < kSteps; ++step) {
    const gpu::TextureId before = step == 0 ? seen_.texture.id() : colors_[step % 2].texture.id();
    draw(colors_[(step + 1) % 2],
         {.program = spread_program_.id(),
          .textures = {{"u_seen", seen_.texture.id()}, {"u_before", before}, {"u_neighbours", neighbours_.texture()}},
          .uniforms = {gpu::uniform("u_vertex_count", vertex_count)},
          .vertex_count = 3});
  }
  return {};
}

}  // namespace fourdvt::render

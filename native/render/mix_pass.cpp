// SPDX-License-Identifier: Apache-2.0
#include "render/passes.h"

namespace fourdvt::render {

Status MixPass::prepare(gpu::Device& device, bool with_flow) {
  const auto make = [&](gpu::Program& out, const char* vertex, const char* fragment, const char* defines) -> Status {
    if (out) return {};
    FOURDVT_ASSIGN(out, makeEmbeddedProgram(device, vertex, fragment, defines));
    return {};
  };
  FOURDVT_TRY(make(mesh_, "mesh_picture.vert", "mesh_picture.frag", ""));
  return with_flow ? make(mix_flow_, "fullscreen.vert", "mix_pictures.frag", "FLOW\n")
                   : make(mix_, "fullscreen.vert", "mix_pictures.frag", "");
}

void MixPass::mix(gpu::Device& device, gpu::TextureId first, gpu::TextureId second, float share_of_second,
                  gpu::TextureId flow) const {
  gpu::Draw draw{.program = flow ? mix_flow_.id() : mix_.id(),
                 .textures = {{"u_first", first}, {"u_second", second}},
                 .uniforms = {gpu::uniform("u_share", share_of_second)},
                 .vertex_count = 3};
  if (flow) draw.textures.push_back({"u_flow", flow});
  device.draw(draw);
}

void MixPass::drawMesh(gpu::Device& device, const CharacterModel& model, gpu::TextureId picture,
                       const CharacterView& view) const {
  device.draw({.program = mesh_.id(),
               .textures = {{"u_corners", model.corners.id()},
                            {"u_positions_normals", model.positions_normals.id()},
                            {"u_shown", picture}},
               .uniforms = {gpu::uniform("u_clip_from_character", view.clip_from_character)},
               .vertex_count = static_cast<int>(3 * model.face_count),
               .depth_test = true,
               .depth_write = true,
               .cull = model.closed_surface ? gpu::Cull::Back : gpu::Cull::None});
}

}  // namespace fourdvt::render

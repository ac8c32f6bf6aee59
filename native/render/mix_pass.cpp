// SPDX-License-Identifier: Apache-2.0
#include <utility>

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

Status MixPass::begin(gpu::Device& device, bool with_flow, int width, int height) {
  FOURDVT_TRY(prepare(device, with_flow));
  for (Canvas& part : parts_) FOURDVT_TRY(part.prepare(device, width, height));
  share_ = 0;
  mixed_ = false;
  return {};
}

Status MixPass::add(gpu::Device& device, const Part& part, FlowSource* flow, int width, int height, Canvas& out) {
  const float share = share_ + part.share;
  const float share_of_second = part.share / share;
  const bool first = std::exchange(share_, share) == 0;
  if (first) return {};
  if (std::exchange(mixed_, true)) std::swap(parts_[0], out);
  const gpu::TextureId before = parts_[0].color.id(), second = parts_[1].color.id();
  if (flow) FOURDVT_TRY(flow->compute(before, second, width, height));
  gpu::Draw draw{.program = flow ? mix_flow_.id() : mix_.id(),
                 .textures = {{"u_first", before}, {"u_second", second}},
                 .uniforms = {gpu::uniform("u_share", share_of_second)},
                 .vertex_count = 3};
  if (flow) draw.textures.push_back({"u_flow", flow->flow()});
  device.beginPass({.target = out.target.id(), .label = "mix"});
  device.draw(draw);
  device.endPass();
  return {};
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

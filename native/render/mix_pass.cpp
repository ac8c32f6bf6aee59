// SPDX-License-Identifier: Apache-2.0
#include "render/passes.h"

namespace fourdvt::render {

namespace {

class MixPass final : public Mixer {
 public:
  bool ready() const override { return mix_ && mesh_; }
  Status prepare(gpu::Device& device, bool with_flow) override;
  Status mix(gpu::Device& device, std::span<const Part> parts, PartPainter& painter, FlowSource* flow, int width,
             int height, Canvas& out) override;
  void drawMesh(gpu::Device& device, const CharacterModel& model, gpu::TextureId picture,
                const CharacterView& view) const override;
  void release() override {
    for (Canvas& part : parts_) part = {};
  }

 private:
  gpu::Program mix_, mix_flow_, mesh_;
  Canvas parts_[2];  // scratch
};

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

Status MixPass::mix(gpu::Device& device, std::span<const Part> parts, PartPainter& painter, FlowSource* flow, int width,
                    int height, Canvas& out) {
  FOURDVT_TRY(prepare(device, flow != nullptr));
  for (Canvas& part : parts_) FOURDVT_TRY(part.prepare(device, width, height));
  painter.paint(parts[0], parts_[0]);
  float before = parts[0].share;
  for (size_t i = 1; i < parts.size(); ++i) {
    if (i > 1) std::swap(parts_[0], out);
    painter.paint(parts[i], parts_[1]);
    const gpu::TextureId first = parts_[0].color.id(), second = parts_[1].color.id();
    if (flow) FOURDVT_TRY(flow->compute(first, second, width, height));
    const float share_of_second = parts[i].share / (before + parts[i].share);
    gpu::Draw draw{.program = flow ? mix_flow_.id() : mix_.id(),
                   .textures = {{"u_first", first}, {"u_second", second}},
                   .uniforms = {gpu::uniform("u_share", share_of_second)},
                   .vertex_count = 3};
    if (flow) draw.textures.push_back({"u_flow", flow->flow()});
    device.beginPass({.target = out.target.id(), .label = "mix"});
    device.draw(draw);
    device.endPass();
    before += parts[i].share;
  }
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

}  // namespace

std::unique_ptr<Mixer> makeMixer() { return std::make_unique<MixPass>(); }

}  // namespace fourdvt::render

// SPDX-License-Identifier: Apache-2.0
#include "render/passes.h"

namespace fourdvt::render {
namespace {

std::vector<gpu::TextureBinding> bindings(const CharacterModel& model, const PictureTextures& picture) {
  std::vector<gpu::TextureBinding> list = {{"u_corners", model.corners.id()},
                                           {"u_positions_normals", model.positions_normals.id()},
                                           {"u_vertex_masks", model.vertex_masks.id()},
                                           {"u_labels", model.labels.id()}};
  if (picture.kind == PictureTextures::Kind::Rgba) {
    list.push_back({"u_picture_rgba", picture.rgba.id()});
    return list;
  }
  list.push_back({"u_picture_y", picture.y.id()});
  list.push_back({"u_picture_u", picture.u.id()});
  list.push_back({"u_picture_v", picture.v.id()});
  return list;
}

bool isSharpened(const RecipeOptions& options) { return options.view_exponent != 1.0f; }

}  // namespace

int LayeredPass::key(const CharacterModel& model, PictureTextures::Kind kind, const RecipeOptions& options) {
  return model.layer_count + 8 * static_cast<int>(kind) + 16 * static_cast<int>(options.debug) +
         (options.paper_weights ? 128 : 0) + (isSharpened(options) ? 256 : 0);
}

Status LayeredPass::prepare(gpu::Device& device, const CharacterModel& model, PictureTextures::Kind kind,
                            const RecipeOptions& options) {
  gpu::Program& program = programs_[key(model, kind, options)];
  if (program) return {};
  std::string defines = "LAYERS " + std::to_string(model.layer_count) + "\n";
  defines += "MAX_CAMERAS " + std::to_string(package::kMaxCameras) + "\n";
  if (kind == PictureTextures::Kind::I420) defines += "PICTURE_I420\n";
  if (options.paper_weights) defines += "PAPER_WEIGHTS\n";
  if (isSharpened(options)) defines += "SHARPENED\n";
  if (options.debug != DebugView::None)
    defines += "DEBUG_VIEW " + std::to_string(static_cast<int>(options.debug)) + "\n";
  auto made = makeEmbeddedProgram(device, "layered.vert", "layered.frag", defines);
  if (!made) return made.error();
  program = made.take();
  return {};
}

void LayeredPass::draw(gpu::Device& device, const CharacterModel& model, const PictureTextures& picture,
                       const View& view, const RecipeOptions& options) const {
  const glm::vec3 view_axis = viewAxis(view);
  device.draw({.program = programs_.at(key(model, picture.kind, options)).id(),
               .textures = bindings(model, picture),
               .uniforms = {gpu::uniform("u_clip_from_world", view.clip_from_world),
                            gpu::uniform("u_eye_in_world", view.eye_in_world), gpu::uniform("u_view_axis", view_axis),
                            gpu::uniform("u_camera_centres", std::span<const glm::vec4>(model.camera_centres)),
                            gpu::uniform("u_camera_forwards", std::span<const glm::vec4>(model.camera_forwards)),
                            gpu::uniform("u_view_exponent", options.view_exponent),
                            gpu::uniform("u_layer_rects", std::span<const glm::vec4>(model.layer_rects_uv)),
                            gpu::uniform("u_picture_size", model.picture_size),
                            gpu::uniform("u_debug_layer", options.debug_layer)},
               .vertex_count = static_cast<int>(3 * model.face_count),
               .depth_test = true,
               .depth_write = true,
               .cull = model.closed_surface ? gpu::Cull::Back : gpu::Cull::None});
}

}  // namespace fourdvt::render

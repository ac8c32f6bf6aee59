// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "render/passes.h"

namespace fourdvt::render {
namespace {

// Lengths for a person.
constexpr float kMargin_m = 0.5f;       // margin of the map round the frame's bounds
constexpr float kExtentStep_m = 0.25f;  // step of the map's extent, so that its texels rarely shift
// Blur widths; kGain in shadow_ground.frag compensates for the loss of darkness.
constexpr float kContactSigma_m = 0.035f, kBodySigma_m = 0.13f;
constexpr float kTapsOfBodySigma = 5.0f;  // the 12 taps on each side (kTaps in shadow_blur.frag) reach 2.4 sigma

glm::vec4 shadowArea(const CharacterModel& model, float ground_y_m) {
  const glm::vec3 low = model.frame_bounds.min, high = model.frame_bounds.max;
  const float half = std::max(high.x - low.x, high.z - low.z) / 2 + model.length_scale * kMargin_m;
  const float step = model.length_scale * kExtentStep_m;
  return {(low.x + high.x) / 2, (low.z + high.z) / 2, std::ceil(half / step) * step, ground_y_m};
}

}  // namespace

Result<gpu::Program> makeEmbeddedProgram(gpu::Device& device, const char* vertex, const char* fragment,
                                         const std::string& defines) {
  const std::string table = "TABLE_WIDTH " + std::to_string(CharacterModel::kTableWidth) + "\n";
  return gpu::makeProgram(device, std::string(vertex) + " + " + fragment, gpu::shaderText(vertex),
                          gpu::shaderText(fragment), table + defines);
}

Result<ShadowPass> ShadowPass::create(gpu::Device& device) {
  ShadowPass pass;
  const auto program = [&](gpu::Program& out, const char* vertex, const char* fragment) -> Status {
    FOURDVT_ASSIGN(out, makeEmbeddedProgram(device, vertex, fragment));
    return {};
  };
  FOURDVT_TRY(program(pass.cast_, "shadow_cast.vert", "shadow_cast.frag"));
  FOURDVT_TRY(program(pass.blur_, "fullscreen.vert", "shadow_blur.frag"));
  FOURDVT_TRY(program(pass.ground_, "shadow_ground.vert", "shadow_ground.frag"));
  FOURDVT_ASSIGN(pass.scratch_, makeMap(device, false));
  return pass;
}

Result<ShadowPass::Map> ShadowPass::makeMap(gpu::Device& device, bool with_depth) {
  Map map;
  FOURDVT_ASSIGN(map.occlusion, gpu::makeTexture(device, {.format = gpu::PixelFormat::RG8,
                                                          .width = kSide,
                                                          .height = kSide,
                                                          .filter = gpu::Filter::Linear,
                                                          .label = "shadow map"}));
  FOURDVT_ASSIGN(
      map.target,
      gpu::makeTarget(device, {.colors = {map.occlusion.id()}, .own_depth = with_depth, .label = "shadow map"}));
  return map;
}

Status ShadowPass::cast(gpu::Device& device, size_t i, const CharacterModel& model, float ground_y_m) {
  while (maps_.size() <= i) {
    auto made = makeMap(device, true);
    if (!made) return made.error();
    maps_.push_back(made.take());
  }
  const bool surface = bool(model.corner_vertices);
  if (surface && !cast_surface_) {
    FOURDVT_ASSIGN(cast_surface_, makeEmbeddedProgram(device, "shadow_cast.vert", "shadow_cast.frag", "INDEXED\n"));
  }
  Map& map = maps_[i];
  if (map.serial == model.geometry_serial && map.area.w == ground_y_m) return {};
  map.serial = model.geometry_serial;
  map.area = shadowArea(model, ground_y_m);
  const float min_height_m = model.length_scale * 0.1f;
  const float height_m = std::max(model.frame_bounds.max.y - ground_y_m, min_height_m) + min_height_m;
  device.beginPass({.target = map.target.id(), .clear_color = true, .clear_depth = true, .label = "shadow cast"});
  const gpu::TextureBinding corners = surface ? gpu::TextureBinding{"u_corner_vertices", model.corner_vertices.id()}
                                              : gpu::TextureBinding{"u_corners", model.corners.id()};
  device.draw(
      {.program = (surface ? cast_surface_ : cast_).id(),
       .textures = {corners, {"u_positions_normals", model.positions_normals.id()}},
       .uniforms = {gpu::uniform("u_ground", map.area), gpu::uniform("u_height_m", height_m),
                    gpu::uniform("u_length_scale", model.length_scale)},
       .vertex_count = model.shadow_corners ? model.shadow_corner_count : static_cast<int>(3 * model.face_count),
       .indices = model.shadow_corners.id(),
       .depth_test = true,
       .depth_write = true});
  device.endPass();
  // Tap distance in units of the map, which is 2 × area.z metres wide.
  const float tap_m = model.length_scale * kBodySigma_m / kTapsOfBodySigma;
  const float tap = tap_m / (2 * map.area.z);
  const glm::vec2 sigma(model.length_scale * kContactSigma_m / tap_m, kTapsOfBodySigma);
  const auto blur = [&](const Map& from, const Map& to, const glm::vec2& step) {
    device.beginPass({.target = to.target.id(), .label = "shadow blur"});
    device.draw({.program = blur_.id(),
                 .textures = {{"u_occlusion", from.occlusion.id()}},
                 .uniforms = {gpu::uniform("u_step", step), gpu::uniform("u_sigma", sigma)},
                 .vertex_count = 3});
    device.endPass();
  };
  blur(map, scratch_, {tap, 0});
  blur(scratch_, map, {0, tap});
  return {};
}

void ShadowPass::drawGround(gpu::Device& device, size_t i, const CharacterView& view, float strength,
                            bool depth_test) const {
  const Map& map = maps_[i];
  device.draw({.program = ground_.id(),
               .textures = {{"u_occlusion", map.occlusion.id()}},
               .uniforms = {gpu::uniform("u_clip_from_character", view.clip_from_character),
                            gpu::uniform("u_eye", view.eye_in_character), gpu::uniform("u_ground", map.area),
                            gpu::uniform("u_strength", strength)},
               .vertex_count = 6,
               .depth_test = depth_test,
               .blend = gpu::Blend::PremultipliedOver,
               .cull = gpu::Cull::Back});
}

}  // namespace fourdvt::render

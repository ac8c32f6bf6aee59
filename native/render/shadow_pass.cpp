// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "render/passes.h"

namespace fourdvt::render {
namespace {

constexpr float kMargin_m = 0.5f;       // of the map round the frame's bounds
constexpr float kExtentStep_m = 0.25f;  // the map's extent changes in steps, so that its texels rarely do
constexpr float kContactSigma_m = 0.035f, kBodySigma_m = 0.13f;
constexpr float kTapsOfBodySigma = 5.0f;  // the kernel's 12 taps a side reach 2.4 sigma

glm::vec4 shadowArea(const CharacterModel& model) {
  const glm::vec3 low = model.frame_bounds.min, high = model.frame_bounds.max;
  const float half = std::max(high.x - low.x, high.z - low.z) / 2 + kMargin_m;
  return {(low.x + high.x) / 2, (low.z + high.z) / 2, std::ceil(half / kExtentStep_m) * kExtentStep_m,
          static_cast<float>(model.ground_y_m)};
}

}  // namespace

Result<gpu::Program> makeEmbeddedProgram(gpu::Device& device, const char* vertex, const char* fragment,
                                         const std::string& defines) {
  const std::string table = "TABLE_WIDTH " + std::to_string(CharacterModel::kTableWidth) + "\n";
  return gpu::makeProgram(device, std::string(vertex) + " + " + fragment, gpu::shaderSource(vertex),
                          gpu::shaderSource(fragment), table + defines);
}

Result<ShadowPass> ShadowPass::create(gpu::Device& device) {
  ShadowPass pass;
  const auto program = [&](gpu::Program& out, const char* vertex, const char* fragment) -> Status {
    auto made = makeEmbeddedProgram(device, vertex, fragment);
    if (!made) return made.error();
    out = made.take();
    return {};
  };
  FOURDVT_TRY(program(pass.cast_, "shadow_cast.vert", "shadow_cast.frag"));
  FOURDVT_TRY(program(pass.blur_, "fullscreen.vert", "shadow_blur.frag"));
  FOURDVT_TRY(program(pass.ground_, "shadow_ground.vert", "shadow_ground.frag"));
  for (int i = 0; i < 2; ++i) {
    auto map = gpu::makeTexture(device, {.format = gpu::PixelFormat::RG8,
                                         .width = kSide,
                                         .height = kSide,
                                         .filter = gpu::Filter::Linear,
                                         .label = "shadow map"});
    if (!map) return map.error();
    pass.maps_[i] = map.take();
    auto target = gpu::makeTarget(
        device, {.colors = {pass.maps_[i].id()}, .own_depth = i == 0, .label = i == 0 ? "shadow cast" : "shadow blur"});
    if (!target) return target.error();
    pass.targets_[i] = target.take();
  }
  return pass;
}

void ShadowPass::cast(gpu::Device& device, const CharacterModel& model) {
  if (serial_ == model.geometry_serial) return;
  serial_ = model.geometry_serial;
  area_ = shadowArea(model);
  const float height_m = std::max(model.frame_bounds.max.y - area_.w, 0.1f) + 0.1f;
  device.beginPass({.target = targets_[0].id(), .clear_color = true, .clear_depth = true, .label = "shadow cast"});
  device.draw({.program = cast_.id(),
               .textures = {{"u_corners", model.corners.id()}, {"u_positions_normals", model.positions_normals.id()}},
               .uniforms = {gpu::uniform("u_ground", area_), gpu::uniform("u_height_m", height_m)},
               .vertex_count = static_cast<int>(3 * model.face_count),
               .depth_test = true,
               .depth_write = true});
  device.endPass();
  // Map units: the map is 2 × area_.z metres wide.
  const float tap_m = kBodySigma_m / kTapsOfBodySigma;
  const float tap = tap_m / (2 * area_.z);
  const glm::vec2 sigma(kContactSigma_m / tap_m, kTapsOfBodySigma);
  const std::array<glm::vec2, 2> steps{glm::vec2(tap, 0), glm::vec2(0, tap)};
  for (int i = 0; i < 2; ++i) {
    device.beginPass({.target = targets_[1 - i].id(), .label = "shadow blur"});
    device.draw({.program = blur_.id(),
                 .textures = {{"u_occlusion", maps_[i].id()}},
                 .uniforms = {gpu::uniform("u_step", steps[i]), gpu::uniform("u_sigma", sigma)},
                 .vertex_count = 3});
    device.endPass();
  }
}

void ShadowPass::drawGround(gpu::Device& device, const View& view, float strength) const {
  device.draw({.program = ground_.id(),
               .textures = {{"u_occlusion", maps_[0].id()}},
               .uniforms = {gpu::uniform("u_clip_from_world", view.clip_from_world), gpu::uniform("u_ground", area_),
                            gpu::uniform("u_strength", strength)},
               .vertex_count = 6,
               .blend = gpu::Blend::PremultipliedOver,
               .cull = gpu::Cull::Back});
}

}  // namespace fourdvt::render

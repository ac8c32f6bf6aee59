// SPDX-License-Identifier: Apache-2.0
// bench_draw_ratio CHARACTER [FRAMES]: milliseconds of the layered draw and of a plain draw of layer 1 alone (one
// texture, no view dependence), of the same frame, size and multisampling; alternating in one run, medians and ratio.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "base/camera.h"
#include "first_frame.h"
#include "platform/egl_context.h"
#include "render/passes.h"

namespace {

using namespace fourdvt;
using fourdvt::testing::FirstFrame;
using fourdvt::testing::median;
using fourdvt::testing::orStop;

constexpr int kWidth = 720, kHeight = 960, kSamples = 4;

// Minimal shader that draws the character with one texture: no labels, no normals, no weights.
constexpr const char* kPlainVertex = R"(
precision highp float;
precision highp sampler2D;
uniform sampler2D u_corners, u_positions_normals;
uniform mat4 u_clip_from_world;
out vec2 v_uv;
ivec2 at(int i) { return ivec2(i % 256, i / 256); }
void main() {
  vec4 corner = texelFetch(u_corners, at(2 * gl_VertexID), 0);
  v_uv = corner.xy;
  gl_Position = u_clip_from_world * vec4(texelFetch(u_positions_normals, at(2 * int(corner.z)), 0).xyz, 1.0);
})";
constexpr const char* kPlainFragment = R"(
precision highp float;
uniform sampler2D u_picture_y, u_picture_u, u_picture_v;
uniform vec4 u_rect;
in vec2 v_uv;
out vec4 o_color;
void main() {
  vec2 uv = u_rect.xy + v_uv * u_rect.zw;
  float y = 1.16438 * (texture(u_picture_y, uv).r - 16.0 / 255.0);
  float u = texture(u_picture_u, uv).r - 128.0 / 255.0, v = texture(u_picture_v, uv).r - 128.0 / 255.0;
  o_color = vec4(y + 1.79274 * v, y - 0.21325 * u - 0.53291 * v, y + 2.11240 * u, 1.0);
})";

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: bench_draw_ratio CHARACTER [FRAMES]\n"), 2;
  const int frames = argc > 2 ? std::max(1, std::atoi(argv[2])) : 60;
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  const FirstFrame scene = testing::loadFirstFrame(*device, argv[1]);
  const render::View view = render::viewFromCamera(
      cameraFromOrbit(defaultOrbit(scene.character.bounds, double(kWidth) / kHeight), kWidth, kHeight));

  const auto many = orStop(gpu::makeTarget(*device, {.width = kWidth,
                                                     .height = kHeight,
                                                     .samples = std::min(kSamples, device->caps().max_samples),
                                                     .own_depth = true,
                                                     .label = "multisampled"}));
  const auto color = orStop(gpu::makeTexture(
      *device, {.format = gpu::PixelFormat::RGBA8, .width = kWidth, .height = kHeight, .label = "resolved"}));
  const auto one = orStop(gpu::makeTarget(*device, {.colors = {color.id()}, .label = "resolved"}));
  const auto plain = orStop(gpu::makeProgram(*device, "plain", kPlainVertex, kPlainFragment));
  render::LayeredPass layered;
  const render::CharacterModel& model = scene.figure.model;
  const render::Look look{&scene.figure.appearance, &scene.picture};
  const render::Part part{&look, {{0, 1}}};
  const render::CharacterView own{view.clip_from_world, view.eye_in_world};  // the character stands at the origin
  orStop(layered.prepare(*device, model, part, own, {}));

  const auto timed = [&](const auto& draw) {
    const auto start = std::chrono::steady_clock::now();
    device->beginPass(
        {.target = many.id(), .width = kWidth, .height = kHeight, .clear_color = true, .clear_depth = true});
    draw();
    device->endPass();
    device->blit(many.id(), one.id(), {.width = kWidth, .height = kHeight});
    uint8_t pixel[4];  // waits until everything is drawn
    orStop(device->readPixels(one.id(), gpu::PixelFormat::RGBA8,
                              {.x = kWidth / 2, .y = kHeight / 2, .width = 1, .height = 1}, pixel));
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  };
  const auto drawLayered = [&] { layered.draw(*device, model, part, own, {}); };
  const auto drawPlain = [&] {
    device->draw({.program = plain.id(),
                  .textures = {{"u_corners", model.corners.id()},
                               {"u_positions_normals", model.positions_normals.id()},
                               {"u_picture_y", scene.picture.y.id()},
                               {"u_picture_u", scene.picture.u.id()},
                               {"u_picture_v", scene.picture.v.id()}},
                  .uniforms = {gpu::uniform("u_clip_from_world", view.clip_from_world),
                               gpu::uniform("u_rect", scene.figure.appearance.layer_rects_uv[0])},
                  .vertex_count = static_cast<int>(3 * model.face_count),
                  .depth_test = true,
                  .depth_write = true,
                  .cull = model.closed_surface ? gpu::Cull::Back : gpu::Cull::None});
  };
  std::vector<double> layered_ms, plain_ms;
  for (int i = -5; i < frames; ++i) {  // the first ones warm up
    const double a = timed(drawLayered), b = timed(drawPlain);
    if (i < 0) continue;
    layered_ms.push_back(a);
    plain_ms.push_back(b);
  }
  std::printf("%s, %dx%d, %d samples, %u faces, %d layers, %d frames\n", device->caps().renderer.c_str(), kWidth,
              kHeight, kSamples, model.face_count, model.layer_count, frames);
  std::printf("layered %.2f ms, plain %.2f ms, ratio %.2f\n", median(layered_ms), median(plain_ms),
              median(layered_ms) / median(plain_ms));
  return 0;
}

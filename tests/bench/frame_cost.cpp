// SPDX-License-Identifier: Apache-2.0
// bench_frame_cost CHARACTER [FRAMES]: a frame of a phone's canvas (780 × 1688, 4 samples), multisampled in the
// figures' region against the whole view: bytes of the targets, and draw times, alternating in one run, with quartiles.
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "first_frame.h"
#include "platform/egl_context.h"
#include "render/recipe.h"

namespace {

using namespace fourdvt;
using fourdvt::testing::FirstFrame;
using fourdvt::testing::orStop;

constexpr int kWidth = 780, kHeight = 1688;

struct Times {
  std::vector<double> ms;
  double at(double share) {
    std::sort(ms.begin(), ms.end());
    return ms[size_t(share * double(ms.size() - 1))];
  }
};

struct Canvas {
  gpu::Texture color;
  gpu::Target target;
};

Canvas makeCanvas(gpu::Device& device) {
  Canvas out;
  out.color = orStop(gpu::makeTexture(device, {.width = kWidth, .height = kHeight, .label = "canvas"}));
  out.target = orStop(gpu::makeTarget(device, {.colors = {out.color.id()}, .label = "canvas"}));
  return out;
}

double timed(gpu::Device& device, const Canvas& canvas, const std::function<void()>& draw) {
  const auto start = std::chrono::steady_clock::now();
  draw();
  uint8_t pixel[4];  // waits until everything is drawn
  orStop(device.readPixels(canvas.target.id(), gpu::PixelFormat::RGBA8,
                           {.x = kWidth / 2, .y = kHeight / 2, .width = 1, .height = 1}, pixel));
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

uint64_t bytesOf(const gpu::Device& device) {
  return device.counters().live_target_bytes + device.counters().live_texture_bytes;
}

// Views round the figure.
std::vector<render::View> orbit(const BoundingBox& bounds, int count) {
  std::vector<render::View> views;
  OrbitView view = defaultOrbit(bounds, double(kWidth) / kHeight);
  for (int i = 0; i < count; ++i, view.azimuth_deg += 360.0 / count)
    views.push_back(render::viewFromCamera(cameraFromOrbit(view, kWidth, kHeight)));
  return views;
}

void raceRegions(gpu::Device& device, const FirstFrame& frame, const Canvas& canvas, int frames) {
  render::Scene unseen;  // with it the whole view is multisampled
  const std::vector<render::SceneCorner> far_below(3, render::SceneCorner{{0, -1000, 0}});
  unseen.meshes.push_back(orStop(render::makeSceneMesh(device, far_below, true)));
  unseen.ground_y_m = float(frame.character.ground_y_m);
  constexpr float kWhole[] = {1};
  const render::Look look{&frame.figure.appearance, &frame.picture, kWhole};
  const render::Figure figure{&frame.figure.model, {&look, 1}};
  const std::vector<render::View> views = orbit(frame.character.bounds, frames);
  Times times[2];
  uint64_t bytes[2] = {};
  const auto whole = orStop(render::Recipe::create(device)), region = orStop(render::Recipe::create(device));
  for (int i = -3; i < frames; ++i)  // the first ones warm up
    for (int kind = 0; kind < 2; ++kind) {
      const uint64_t before = bytesOf(device);
      const double ms = timed(device, canvas, [&] {
        orStop((kind ? region : whole)
                   ->draw({&figure, 1}, kind ? nullptr : &unseen, views[size_t(std::max(i, 0))],
                          {{}, render::Align::None}, canvas.target.id()));
      });
      bytes[kind] += bytesOf(device) - before;
      if (i >= 0) times[kind].ms.push_back(ms);
    }
  for (int kind = 0; kind < 2; ++kind)
    std::printf("%-12s targets %5.1f MB, draw %6.2f ms (quartiles %6.2f - %6.2f)\n", kind ? "region" : "whole view",
                double(bytes[kind]) / 1e6, times[kind].at(0.5), times[kind].at(0.25), times[kind].at(0.75));
  std::printf("region / whole view: draw %.2f\n", times[1].at(0.5) / times[0].at(0.5));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: bench_frame_cost CHARACTER [FRAMES]\n"), 2;
  const int frames = argc > 2 ? std::max(1, std::atoi(argv[2])) : 60;
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  const FirstFrame frame = testing::loadFirstFrame(*device, argv[1]);
  const Canvas canvas = makeCanvas(*device);
  std::printf("%s, %dx%d, %u faces, %d frames\n", device->caps().renderer.c_str(), kWidth, kHeight,
              frame.figure.model.face_count, frames);
  raceRegions(*device, frame, canvas, frames);
  return 0;
}

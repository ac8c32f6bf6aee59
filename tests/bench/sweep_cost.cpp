// SPDX-License-Identifier: Apache-2.0
// bench_sweep_cost CHARACTER [SEQUENCE [FRAMES [WIDTH HEIGHT]]]: cost of a frame by "sweep" and by "fvvr" on a
// character from cameras, by number of planes, alternating in one run: before the main pass (depth maps and unseen
// surface, in both methods), and in it.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "edge/character_player.h"
#include "or_stop.h"
#include "platform/egl_context.h"
#include "render/cameras/camera_method.h"
#include "render/passes.h"

namespace {

using namespace fourdvt;
using fourdvt::testing::orStop;
using Clock = std::chrono::steady_clock;

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

class Bench {
 public:
  Bench(gpu::Device& device, int width, int height) : device_(device), width_(width), height_(height) {
    many_ = orStop(gpu::makeTarget(device, {.width = width,
                                            .height = height,
                                            .samples = std::min(4, device.caps().max_samples),
                                            .own_depth = true,
                                            .label = "multisampled"}));
    color_ = orStop(gpu::makeTexture(device, {.width = width, .height = height, .label = "resolved"}));
    one_ = orStop(gpu::makeTarget(device, {.colors = {color_.id()}, .label = "resolved"}));
  }

  // Milliseconds before the main pass, and in it.
  struct Frame {
    double before = 0, main = 0;
  };
  Frame frame(render::Method& method, const render::CharacterModel& model, const render::CameraLook& look,
              const render::CharacterView& view, const render::MethodOptions& options) {
    Frame out;
    wait();
    auto start = Clock::now();
    orStop(method.prepare(device_, 0, model, look, view, options));
    wait();
    out.before = millisecondsSince(start);
    start = Clock::now();
    device_.beginPass({.target = many_.id(), .clear_color = true, .clear_depth = true});
    method.draw(device_, 0, model, look, view, options);
    device_.endPass();
    device_.blit(many_.id(), one_.id(), {.width = width_, .height = height_});
    wait();
    out.main = millisecondsSince(start);
    return out;
  }

 private:
  void wait() {
    uint8_t pixel[4];
    orStop(device_.readPixels(one_.id(), gpu::PixelFormat::RGBA8, {.width = 1, .height = 1}, pixel));
  }
  gpu::Device& device_;
  const int width_, height_;
  gpu::Target many_, one_;
  gpu::Texture color_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2)
    return std::fprintf(stderr, "usage: bench_sweep_cost CHARACTER [SEQUENCE [FRAMES [WIDTH HEIGHT]]]\n"), 2;
  const std::string sequence = argc > 2 ? argv[2] : "run";
  const int frames = argc > 3 ? std::max(1, std::atoi(argv[3])) : 9;
  const int width = argc > 5 ? std::atoi(argv[4]) : 720, height = argc > 5 ? std::atoi(argv[5]) : 960;
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  Bench bench(*device, width, height);
  const auto player = orStop(edge::CharacterPlayer::open(*device, argv[1]));
  orStop(player->showFrame(sequence, 5));
  const render::Figure figure = orStop(player->player().figure());
  auto& model = *const_cast<render::CharacterModel*>(figure.model);
  const render::View seen = render::viewFromCamera(
      cameraFromOrbit(defaultOrbit(player->player().character()->bounds, double(width) / height), width, height));
  const render::CharacterView view = render::viewOfFigure(seen, figure);
  std::printf("%s; %u faces, view of %d x %d; medians of %d frames, every one with a new surface; milliseconds\n",
              device->caps().renderer.c_str(), model.face_count, width, height, frames);
  std::printf("planes   fvvr: before  main    sweep: before  main   frame / fvvr's\n");
  for (const int planes : {4, 8, 12, 16, 24, 32}) {
    const auto fvvr = orStop(render::makeCameraMethod(*device, "fvvr")),
               sweep = orStop(render::makeCameraMethod(*device, "sweep"));
    render::MethodOptions options;
    options.sweep.planes = planes;
    std::vector<double> times[4];
    for (int i = 0; i < frames + 2; ++i) {
      model.geometry_serial += 1'000'000;
      const auto a = bench.frame(*fvvr, model, *figure.cameras, view, options);
      const auto b = bench.frame(*sweep, model, *figure.cameras, view, options);
      if (i < 2) continue;  // they compile programs
      for (const auto& [k, value] : {std::pair(0, a.before), {1, a.main}, {2, b.before}, {3, b.main}})
        times[k].push_back(value);
    }
    double t[4];
    for (int k = 0; k < 4; ++k) t[k] = median(times[k]);
    std::printf("%6d %14.2f %6.2f %14.2f %6.2f %14.2f\n", planes, t[0], t[1], t[2], t[3],
                (t[2] + t[3]) / (t[0] + t[1]));
  }
  return 0;
}

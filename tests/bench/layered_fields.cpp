// SPDX-License-Identifier: Apache-2.0
// bench_layered_fields CHARACTER [PICTURES]: milliseconds of a whole picture of a layered character by Montage4D over
// layers and by the plain blend, in turns in one run. Distances from the seams are computed for new geometry only;
// hence two kinds of pictures: of the frame shown before, and of a new one.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "edge/character_player.h"
#include "or_stop.h"
#include "platform/egl_context.h"
#include "render/montage/layered_montage.h"

namespace {

using namespace fourdvt;
using fourdvt::testing::orStop;

constexpr int kWidth = 720, kHeight = 960;

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: bench_layered_fields CHARACTER [PICTURES]\n"), 2;
  const int pictures = argc > 2 ? std::max(1, std::atoi(argv[2])) : 40;
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  const auto player = orStop(edge::CharacterPlayer::open(*device, std::string(argv[1]) + "/character.gltf"));
  const package::Character& character = *player->player().character();
  orStop(player->showFrame(character.sequences.front().name, 0));
  const auto plain = orStop(render::Recipe::create(*device)), montage = orStop(render::Recipe::create(*device));
  montage->setLayered(orStop(render::makeLayeredMontage(*device)));
  const render::Figure figure = orStop(player->player().figure());
  // Excludes the upload of a new frame's mesh, which is the same for both.
  auto& model = const_cast<render::CharacterModel&>(*figure.model);
  const render::View view = render::viewFromCamera(
      cameraFromOrbit(defaultOrbit(character.bounds, double(kWidth) / kHeight), kWidth, kHeight));
  const auto color = orStop(gpu::makeTexture(*device, {.width = kWidth, .height = kHeight, .label = "picture"}));
  const auto target = orStop(gpu::makeTarget(*device, {.colors = {color.id()}, .label = "picture"}));

  struct Cost {
    double wall_ms = 0, processor_ms = 0;  // of all threads; hardly affected by other processes
  };
  const auto timed = [&](render::Recipe& recipe, bool new_frame) {
    if (new_frame) model.geometry_serial += 1'000'000;
    render::DrawOptions options;
    options.method.elapsed_s = 1 / 60.0f;
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t processor_start = std::clock();
    orStop(recipe.draw({&figure, 1}, nullptr, view, options, target.id()));
    uint8_t pixel[4];  // waits until everything is drawn
    orStop(device->readPixels(target.id(), gpu::PixelFormat::RGBA8,
                              {.x = kWidth / 2, .y = kHeight / 2, .width = 1, .height = 1}, pixel));
    return Cost{std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count(),
                1e3 * double(std::clock() - processor_start) / CLOCKS_PER_SEC};
  };
  std::vector<Cost> costs[2][2];       // [new frame][plain, montage4d]
  for (int i = -5; i < pictures; ++i)  // the first ones warm up
    for (int kind = 0; kind < 2; ++kind)
      for (const bool new_frame : {true, false}) {
        const Cost cost = timed(kind ? *montage : *plain, new_frame);
        if (i >= 0) costs[new_frame][kind].push_back(cost);
      }
  std::printf("%s, %dx%d, %u faces, %d layers\n", device->caps().renderer.c_str(), kWidth, kHeight, model.face_count,
              model.layer_count);
  for (const bool new_frame : {false, true})
    for (const auto& [what, field] : {std::pair{"wall", &Cost::wall_ms}, {"processor", &Cost::processor_ms}}) {
      double values[2];
      for (int kind = 0; kind < 2; ++kind) {
        std::vector<double> all;
        for (const Cost& cost : costs[new_frame][kind]) all.push_back(cost.*field);
        values[kind] = median(std::move(all));
      }
      std::printf("%-21s %-9s plain %.2f ms, montage4d %.2f ms, ratio %.2f\n",
                  new_frame ? "a new frame" : "the same frame again", what, values[0], values[1],
                  values[1] / values[0]);
    }
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// bench_montage_fields CAMERAS [SEQUENCE [FRAMES]]: milliseconds of a picture of a character from cameras by FVVR,
// Holoportation's blend and Montage4D, with ratios to FVVR: of a new frame, and of another view of the same frame; and
// the part of Montage4D's time that its fields take (visibility of vertices, votes, seams and their distances; the
// view's target values, and their smoothing over time). Alternating in one run, medians.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "edge/character_player.h"
#include "or_stop.h"
#include "platform/egl_context.h"
#include "render/cameras/camera_method.h"
#include "render/passes.h"

namespace {

using namespace fourdvt;
using fourdvt::testing::orStop;

constexpr int kWidth = 720, kHeight = 960, kSamples = 4;
constexpr const char* kMethods[] = {"fvvr", "holoportation", "montage4d"};
constexpr size_t kCount = std::size(kMethods);

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: bench_montage_fields CAMERAS [SEQUENCE [FRAMES]]\n"), 2;
  const std::string sequence = argc > 2 ? argv[2] : "run";
  const int rounds = argc > 3 ? std::max(1, std::atoi(argv[3])) : 15;
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  const auto player = orStop(edge::CharacterPlayer::open(*device, argv[1]));
  orStop(player->showFrame(sequence, 5));
  const render::Figure figure = orStop(player->player().figure());
  auto& model = *const_cast<render::CharacterModel*>(figure.model);
  const gpu::Target many = orStop(gpu::makeTarget(*device, {.width = kWidth,
                                                            .height = kHeight,
                                                            .samples = std::min(kSamples, device->caps().max_samples),
                                                            .own_depth = true,
                                                            .label = "multisampled"}));
  const gpu::Texture color = orStop(gpu::makeTexture(*device, {.width = kWidth, .height = kHeight, .label = "one"}));
  const gpu::Target one = orStop(gpu::makeTarget(*device, {.colors = {color.id()}, .label = "one"}));
  const auto wait = [&] {  // for all earlier GPU work, in order
    device->beginPass({.target = one.id(), .width = 1, .height = 1, .clear_color = true});
    device->endPass();
    uint8_t pixel[4];
    orStop(device->readPixels(one.id(), gpu::PixelFormat::RGBA8, {.width = 1, .height = 1}, pixel));
  };
  const auto timed = [&](const std::function<void()>& work) {
    wait();
    const auto start = std::chrono::steady_clock::now();
    work();
    wait();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  };
  const package::Character& character = *player->player().character();
  auto orbit = defaultOrbit(character.bounds, double(kWidth) / kHeight);
  const auto viewAt = [&](int i) {
    auto turned = orbit;
    turned.azimuth_deg += 0.6 * (i % 2);  // the same cameras
    return render::viewOfFigure(render::viewFromCamera(cameraFromOrbit(turned, kWidth, kHeight)), figure);
  };
  std::printf("%u faces, view of %d x %d, %d samples, %s; milliseconds, and × FVVR\n", model.face_count, kWidth,
              kHeight, kSamples, device->caps().renderer.c_str());
  for (const int m : {4, 8}) {
    if (size_t(m) > character.cameras.size()) break;
    std::vector<std::unique_ptr<render::Method>> methods;
    for (const char* name : kMethods) methods.push_back(orStop(render::makeCameraMethod(*device, name)));
    const render::MethodOptions options{.closest = m, .elapsed_s = 1.0f / 60};
    std::vector<double> times[kCount][3];  // prepare of a new frame, of another view; draw
    for (int i = 0; i < rounds + 2; ++i)
      for (size_t k = 0; k < kCount; ++k) {
        const auto prepare = [&](const render::CharacterView& view) {
          orStop(methods[k]->prepare(*device, 0, model, *figure.cameras, view, options));
        };
        model.geometry_serial += 1'000'000;
        const auto first = viewAt(i), second = viewAt(i + 1);
        const double t[] = {
            timed([&] { prepare(first); }), timed([&] { prepare(second); }), timed([&] {
              device->beginPass(
                  {.target = many.id(), .width = kWidth, .height = kHeight, .clear_color = true, .clear_depth = true});
              methods[k]->draw(*device, 0, model, *figure.cameras, second, options);
              device->endPass();
              device->blit(many.id(), one.id(), {.width = kWidth, .height = kHeight});
            })};
        for (int part = 0; part < 3 && i >= 2; ++part) times[k][part].push_back(t[part]);
      }
    double parts[kCount][3];
    for (size_t k = 0; k < kCount; ++k)
      for (int part = 0; part < 3; ++part) parts[k][part] = median(times[k][part]);
    const double frame = parts[0][0] + parts[0][2], view = parts[0][1] + parts[0][2];
    std::printf("%d cameras:        new frame          another view       draw\n", m);
    for (size_t k = 0; k < kCount; ++k) {
      const double a = parts[k][0] + parts[k][2], b = parts[k][1] + parts[k][2];
      std::printf("  %-14s  %7.2f (%4.2f)    %7.2f (%4.2f)    %7.2f\n", kMethods[k], a, a / frame, b, b / view,
                  parts[k][2]);
    }
    const double per_frame = parts[2][0] - parts[0][0], per_view = parts[2][1] - parts[0][1];
    std::printf("  fields          %7.2f, %2.0f %%    %7.2f, %2.0f %% of Montage4D's\n", per_frame,
                100 * per_frame / (parts[2][0] + parts[2][2]), per_view, 100 * per_view / (parts[2][1] + parts[2][2]));
  }
}

// SPDX-License-Identifier: Apache-2.0
// bench_camera_frames CAMERAS LAYERED [SEQUENCE [FRAMES]]: milliseconds of a video frame of a character from cameras,
// by part and number of cameras M: upload of the pictures (all tiles in one picture, or M whole ones, as in OVH03 5.3),
// depth maps, colours of unseen surface, shading; and of the draw of a layered character. Alternating in one run,
// medians.
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

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

// Planes of a picture of arbitrary content.
struct Planes {
  Planes(int w, int h) : width(w), height(h), bytes(size_t(w) * h * 3 / 2, 90) {}
  I420View view() const {
    const uint8_t *y = bytes.data(), *u = y + size_t(width) * height, *v = u + size_t(width / 2) * (height / 2);
    return {width, height, y, u, v, width, width / 2, width / 2};
  }
  int width, height;
  std::vector<uint8_t> bytes;
};

class Bench {
 public:
  Bench(gpu::Device& device, int frames) : device_(device), frames_(frames) {
    many_ = orStop(gpu::makeTarget(device, {.width = kWidth,
                                            .height = kHeight,
                                            .samples = std::min(kSamples, device.caps().max_samples),
                                            .own_depth = true,
                                            .label = "multisampled"}));
    color_ = orStop(gpu::makeTexture(device, {.width = kWidth, .height = kHeight, .label = "resolved"}));
    one_ = orStop(gpu::makeTarget(device, {.colors = {color_.id()}, .label = "resolved"}));
  }

  // Medians of the works' times, measured in turn.
  std::vector<double> medians(const std::vector<std::function<void()>>& works) {
    std::vector<std::vector<double>> times(works.size());
    for (int i = 0; i < frames_ + 2; ++i)
      for (size_t w = 0; w < works.size(); ++w) {
        wait();
        const auto start = std::chrono::steady_clock::now();
        works[w]();
        wait();
        const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        if (i >= 2) times[w].push_back(ms);  // the first ones compile programs
      }
    std::vector<double> out;
    for (auto& t : times) out.push_back(median(std::move(t)));
    return out;
  }

  void pass(const std::function<void()>& draw) {
    device_.beginPass(
        {.target = many_.id(), .width = kWidth, .height = kHeight, .clear_color = true, .clear_depth = true});
    draw();
    device_.endPass();
    device_.blit(many_.id(), one_.id(), {.width = kWidth, .height = kHeight});
  }

 private:
  void wait() {
    uint8_t pixel[4];
    orStop(device_.readPixels(one_.id(), gpu::PixelFormat::RGBA8, {.width = 1, .height = 1}, pixel));
  }

  gpu::Device& device_;
  const int frames_;
  gpu::Target many_, one_;
  gpu::Texture color_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "usage: bench_camera_frames CAMERAS LAYERED [SEQUENCE [FRAMES]]\n"), 2;
  const std::string sequence = argc > 3 ? argv[3] : "run";
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  Bench bench(*device, argc > 4 ? std::max(1, std::atoi(argv[4])) : 15);
  const auto cameras = orStop(edge::CharacterPlayer::open(*device, argv[1]));
  const auto layered = orStop(edge::CharacterPlayer::open(*device, argv[2]));
  for (const auto& player : {cameras.get(), layered.get()}) orStop(player->showFrame(sequence, 5));
  const package::Character& character = *cameras->player().character();
  const package::Rendition& rendition = character.find(sequence)->renditions.back();
  const render::Figure figure = orStop(cameras->player().figure()), other = orStop(layered->player().figure());
  auto& model = *const_cast<render::CharacterModel*>(figure.model);
  const render::View seen = render::viewFromCamera(
      cameraFromOrbit(defaultOrbit(character.bounds, double(kWidth) / kHeight), kWidth, kHeight));
  const render::CharacterView view = render::viewOfFigure(seen, figure);
  const size_t all = character.cameras.size();
  std::printf("%u faces, %zu cameras of %d x %d, tiled picture %d x %d; view of %d x %d, %d samples; milliseconds\n",
              model.face_count, all, character.cameras[0].width, character.cameras[0].height, rendition.width,
              rendition.height, kWidth, kHeight, kSamples);

  render::LayeredPass pass;
  const std::vector<render::Part> parts = render::partsOf(other, {});
  orStop(pass.prepare(*device, *other.model, parts[0], view, {}));
  const Planes tiled(rendition.width, rendition.height), whole(character.cameras[0].width, character.cameras[0].height);
  auto packed = orStop(render::createPicture(*device, tiled.width, tiled.height, render::PictureTextures::Kind::I420));
  std::vector<render::PictureTextures> unpacked;
  for (size_t c = 0; c < all; ++c)
    unpacked.push_back(
        orStop(render::createPicture(*device, whole.width, whole.height, render::PictureTextures::Kind::I420)));

  std::printf("  M  upload: packed  unpacked  depth maps  unseen  shading  layered  frames/s packed  unpacked\n");
  for (const int m : {2, 3, 4, 5, 6, 8}) {
    if (size_t(m) > all) break;
    const auto maps_alone = orStop(render::makeCameraMethod(*device, "fvvr")),
               method = orStop(render::makeCameraMethod(*device, "fvvr"));
    render::MethodOptions options{.closest = m}, without = options;
    without.unseen = render::Unseen::BestFacing;
    const render::CameraLook& look = *figure.cameras;
    const auto newSurface = [&] { model.geometry_serial += 1'000'000; };
    const auto t = bench.medians({
        [&] { render::uploadPicture(*device, packed, tiled.view()); },
        [&] {
          for (int i = 0; i < m; ++i) render::uploadPicture(*device, unpacked[size_t(i)], whole.view());
        },
        [&] {
          newSurface();
          orStop(maps_alone->prepare(*device, 0, model, look, view, without));
        },
        [&] {
          newSurface();
          orStop(method->prepare(*device, 0, model, look, view, options));
        },
        [&] { bench.pass([&] { method->draw(*device, 0, model, look, view, options); }); },
        [&] { bench.pass([&] { pass.draw(*device, *other.model, parts[0], view, {}); }); },
    });
    const double frame = t[3] + t[4];
    std::printf("%3d  %14.2f  %8.2f  %10.2f  %6.2f  %7.2f  %7.2f  %15.1f  %8.1f\n", m, t[0], t[1], t[2], t[3] - t[2],
                t[4], t[5], 1000 / (t[0] + frame), 1000 / (t[1] + frame));
  }
}

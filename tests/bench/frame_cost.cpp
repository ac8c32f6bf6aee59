// SPDX-License-Identifier: Apache-2.0
// bench_frame_cost CHARACTER [FRAMES]: a frame on a phone's canvas (780 × 1688, 4 samples), multisampled in the
// figures' region only or in the whole view: bytes of the targets, and draw times, alternating in one run, with
// quartiles.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numeric>

#include "first_frame.h"
#include "platform/egl_context.h"
#include "render/recipe.h"
#include "render/shared_corners.h"

namespace {

using namespace fourdvt;
using fourdvt::testing::FirstFrame;
using fourdvt::testing::orStop;

struct Canvas {
  int width, height, samples;
  gpu::Texture color;
  gpu::Target target;
};

Canvas makeCanvas(gpu::Device& device, int width, int height, int samples) {
  Canvas out{width, height, samples, {}, {}};
  out.color = orStop(gpu::makeTexture(device, {.width = width, .height = height, .label = "canvas"}));
  out.target = orStop(gpu::makeTarget(device, {.colors = {out.color.id()}, .label = "canvas"}));
  return out;
}

double timed(gpu::Device& device, const Canvas& canvas, const std::function<void()>& draw) {
  const auto start = std::chrono::steady_clock::now();
  draw();
  uint8_t pixel[4];  // waits until everything is drawn
  orStop(device.readPixels(canvas.target.id(), gpu::PixelFormat::RGBA8,
                           {.x = canvas.width / 2, .y = canvas.height / 2, .width = 1, .height = 1}, pixel));
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

uint64_t bytesOf(const gpu::Device& device) {
  return device.counters().live_target_bytes + device.counters().live_texture_bytes;
}

// Views round the figure.
std::vector<render::View> orbit(const BoundingBox& bounds, const Canvas& canvas, int count) {
  std::vector<render::View> views;
  OrbitView view = defaultOrbit(bounds, double(canvas.width) / canvas.height);
  for (int i = 0; i < count; ++i, view.azimuth_deg += 360.0 / count)
    views.push_back(render::viewFromCamera(cameraFromOrbit(view, canvas.width, canvas.height)));
  return views;
}

struct Variant {
  const char* name;
  bool in_region, shares;  // shared corners, and a shadow of fewer faces
  std::unique_ptr<render::Recipe> recipe;
  render::PlainFigure figure;
  uint64_t bytes = 0;
  std::vector<double> ms;
};

Variant makeVariant(gpu::Device& device, const FirstFrame& frame, const char* name, bool in_region, bool shares) {
  Variant out{name, in_region, shares, orStop(render::Recipe::create(device)), {}, 0, {}};
  out.figure = orStop(render::PlainFigure::create(device, frame.character, frame.mesh));
  out.figure.setLayout(frame.character.sequences.at(0).renditions.back());
  return out;
}

// Sets a new frame, with separate corners for every face unless the variant shares them.
void setFrame(gpu::Device& device, const FirstFrame& frame, Variant& variant) {
  render::CharacterModel& model = variant.figure.model;
  variant.figure.setFrame(device, frame.positions, frame.labels());
  if (variant.shares) return;
  std::vector<uint32_t> each(3 * model.face_count);
  std::iota(each.begin(), each.end(), 0u);
  device.updateIndices(variant.figure.appearance.corners.id(), each);
  model.shadow_corners.reset();
}

void printVariant(const Variant& v, const Variant& first) {
  const auto at = [](std::vector<double> ms, double share) {
    std::sort(ms.begin(), ms.end());
    return ms[size_t(share * double(ms.size() - 1))];
  };
  std::printf("%-27s targets %5.1f MB, draw %6.2f ms (quartiles %6.2f - %6.2f), ratio %.2f\n", v.name,
              double(v.bytes) / 1e6, at(v.ms, 0.5), at(v.ms, 0.25), at(v.ms, 0.75), at(v.ms, 0.5) / at(first.ms, 0.5));
}

// Draws new frames from all sides, shadows included.
void race(gpu::Device& device, const FirstFrame& frame, const Canvas& canvas, int frames) {
  render::Scene unseen;  // forces multisampling of the whole view
  const std::vector<render::SceneCorner> far_below(3, render::SceneCorner{{0, -1000, 0}});
  unseen.meshes.push_back(orStop(render::makeSceneMesh(device, far_below, true)));
  unseen.ground_y_m = float(frame.character.ground_y_m);
  constexpr float kWhole[] = {1};
  const std::vector<render::View> views = orbit(frame.character.bounds, canvas, frames);
  std::printf("%dx%d, %d samples\n", canvas.width, canvas.height, canvas.samples);
  std::vector<Variant> variants;
  variants.push_back(makeVariant(device, frame, "whole view, corners alone", false, false));
  variants.push_back(makeVariant(device, frame, "region, corners alone", true, false));
  variants.push_back(makeVariant(device, frame, "region, corners shared", true, true));
  for (int i = -3; i < frames; ++i)  // the first ones warm up
    for (Variant& variant : variants) {
      setFrame(device, frame, variant);
      const render::Look look{&variant.figure.appearance, &frame.picture, kWhole};
      const render::Figure figure{&variant.figure.model, {&look, 1}};
      const uint64_t before = bytesOf(device);
      const double ms = timed(device, canvas, [&] {
        orStop(variant.recipe->draw({&figure, 1}, variant.in_region ? nullptr : &unseen, views[size_t(std::max(i, 0))],
                                    {{.samples = canvas.samples}, render::Align::None}, canvas.target.id()));
      });
      variant.bytes += bytesOf(device) - before;
      if (i >= 0) variant.ms.push_back(ms);
    }
  for (const Variant& variant : variants) printVariant(variant, variants[0]);
}

// Number of vertices shaded by a GPU that caches the last `kept` of them.
size_t shadedOf(std::span<const uint32_t> corners, size_t kept) {
  std::vector<size_t> shaded_at(1 + *std::max_element(corners.begin(), corners.end()), 0);  // 1-based; 0: never
  size_t shaded = 0;
  for (const uint32_t corner : corners)
    if (!shaded_at[corner] || shaded_at[corner] + kept <= shaded) shaded_at[corner] = ++shaded;
  return shaded;
}

void printShaded(const char* what, size_t corners, std::span<const uint32_t> list, int fetches) {
  std::printf("%-9s", what);
  for (const size_t kept : {size_t(16), size_t(32), corners}) {
    const size_t shaded = shadedOf(list, kept);
    std::printf("  %6zu (%.2f)", shaded, double(shaded) / double(corners));
  }
  std::printf("  fetches %zu -> %zu\n", corners * size_t(fetches), shadedOf(list, 32) * size_t(fetches));
}

// Vertex shader runs of a new frame, without and with lists of shared corners.
void countVertices(const FirstFrame& frame) {
  const MeshTopology& t = frame.mesh.topology;
  const size_t corners = 3 * t.faceCount(), member_labels = size_t(frame.character.layer_count) * t.faceCount();
  const auto before = render::cornersBefore(t.face_uvs, t.uvs.size());
  std::vector<uint32_t> shared;
  std::vector<double> ms;
  const size_t frames = frame.chunk.frame_count, frame_labels = frame.chunk.labels.size() / frames;
  for (size_t i = 0; i < frames; ++i) {
    std::vector<uint32_t> packed(t.faceCount(), ~0u), masks(t.vertex_count, ~0u);
    render::packLabels(t.face_vertices, std::span(frame.chunk.labels).subspan(i * frame_labels, member_labels),
                       int(frame.character.cameras.size()), packed, masks);
    const auto start = std::chrono::steady_clock::now();
    render::shareCorners(before, t.face_vertices, packed, shared);
    ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::printf(
      "vertex shader runs of %zu corners if the last 16, 32, all are kept; table fetches without -> with (32)\n",
      corners);
  printShaded("layered", corners, shared, 5);  // corner, position, normal, mask, labels
  const auto start = std::chrono::steady_clock::now();
  const auto coarse = render::shadowCorners(t.face_vertices, frame.mesh.positions, float(frame.character.ground_y_m),
                                            float(frame.character.length_scale));
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
  printShaded("shadow", corners, coarse, 2);
  std::printf("faces that cast the shadow: %zu, chosen once in %.2f ms\n", coarse.size() / 3, taken.count());
  std::printf("list of a frame: %.3f ms, %.0f kB\n", testing::median(ms), double(4 * corners) / 1e3);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: bench_frame_cost CHARACTER [FRAMES]\n"), 2;
  const int frames = argc > 2 ? std::max(1, std::atoi(argv[2])) : 60;
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  const FirstFrame frame = testing::loadFirstFrame(*device, argv[1]);
  std::printf("%s, %u faces, %d frames\n", device->caps().renderer.c_str(), frame.figure.model.face_count, frames);
  race(*device, frame, makeCanvas(*device, 780, 1688, 4), frames);
  race(*device, frame, makeCanvas(*device, 78, 169, 0), frames);  // small, so that vertices dominate
  countVertices(frame);
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// bench_floating_cost CAPTURE [SEQUENCE [REPEATS]]: milliseconds of a view of a capture's first frame by the variants
// of Floating Textures, by their blend without flow, and by FVVR, from three and from four cameras, with ratios; one
// flow at the view's size, as between pairs, and one at half of it, as in the mean variant's last round; the flows'
// share of the pairs' time, and an estimate with flows of half the size. The scene is still: depth maps are drawn once.
// Alternating in one run, medians; times include waiting for the GPU.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "bake/method/frame_drawing.h"
#include "capture/capture.h"
#include "mattes/frame_reader.h"
#include "or_stop.h"
#include "platform/egl_context.h"
#include "platform/ffmpeg_video.h"
#include "render/cameras/camera_method.h"
#include "render/cameras/floating_pictures.h"

namespace {

using namespace fourdvt;
using fourdvt::testing::orStop;

constexpr int kWidth = 720, kHeight = 960;

struct Lane {
  const char* name;
  const char* method;
  bool new_picture;  // set before each view, as in playback
  std::unique_ptr<bake::FrameDrawing> stage = nullptr;
  std::vector<double> times_ms = {};
};

struct Flow {
  const char* name;
  int octaves;  // levels below the view's size
  std::unique_ptr<render::FlowSource> source;
  std::vector<double> times_ms = {};
};

// Reads one texel of a flow back.
void waitFor(gpu::Device& device, gpu::TextureId flow) {
  const auto target = orStop(gpu::makeTarget(device, {.colors = {flow}, .label = "flow"}));
  glm::vec2 value;
  orStop(device.readPixels(target.id(), gpu::PixelFormat::RG16F, {.width = 1, .height = 1}, &value));
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: bench_floating_cost CAPTURE [SEQUENCE [REPEATS]]\n"), 2;
  const std::string sequence_name = argc > 2 ? argv[2] : "run";
  const int repeats = argc > 3 ? std::max(1, std::atoi(argv[3])) : 5;
  const OpenVideo open_video = [](const std::string& path, int channels) {
    return platform::openVideoFile(path, channels);
  };
  const auto capture = orStop(mattes::openCapture(argv[1], open_video, {sequence_name}, capture::MeshNeed::AnySurface));
  const capture::CaptureSequence& sequence = capture.sequences.at(0);
  const auto reader = orStop(mattes::FrameReader::open(capture, sequence, open_video));
  const auto captured = orStop(reader->next());
  const TriangleMesh surface = orStop(capture::readSurfaceFrame(capture, sequence, 0));
  std::vector<PinholeCamera> cameras;
  for (const capture::CaptureCamera& camera : capture.cameras) cameras.push_back(camera.pinhole);

  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  Lane lanes[] = {{"fvvr", "fvvr", false},
                  {"linear", "linear", false},
                  {"star", "floating", false},
                  {"pairs", "floating-pairs", false},
                  {"static, a view", "floating-static", false},
                  {"static, a frame", "floating-static", true}};
  for (Lane& lane : lanes) {
    lane.stage = orStop(bake::FrameDrawing::create(*device, cameras));
    orStop(lane.stage->setFrame(surface, captured.pictures));
  }
  gpu::Texture colors[2];
  gpu::Target targets[2];
  for (int k = 0; k < 2; ++k) {
    colors[k] = orStop(gpu::makeTexture(
        *device, {.width = kWidth, .height = kHeight, .filter = gpu::Filter::Linear, .label = "view"}));
    targets[k] = orStop(gpu::makeTarget(*device, {.colors = {colors[k].id()}, .label = "view"}));
  }
  const gpu::Target& target = targets[0];
  const auto wait = [&] {
    uint8_t pixel[4];
    orStop(device->readPixels(target.id(), gpu::PixelFormat::RGBA8, {.width = 1, .height = 1}, pixel));
  };
  BoundingBox bounds{surface.positions[0], surface.positions[0]};
  for (const glm::vec3& position : surface.positions) {
    bounds.min = glm::min(bounds.min, position);
    bounds.max = glm::max(bounds.max, position);
  }
  const render::View view =
      render::viewFromCamera(cameraFromOrbit(defaultOrbit(bounds, double(kWidth) / kHeight), kWidth, kHeight));
  std::printf("%s, %zu faces, view of %d x %d, medians of %d\n", device->caps().renderer.c_str(), surface.faces.size(),
              kWidth, kHeight, repeats);
  // Two different pictures of the view, by two methods, as input of the flows.
  for (int k = 0; k < 2; ++k) {
    lanes[k].stage->setMethod(orStop(render::makeCameraMethod(*device, lanes[k].method)));
    orStop(lanes[k].stage->draw(view, {.closest = 3 - 2 * k}, targets[k].id()));
  }
  Flow flows[] = {{"of the view's size", 0,
                   orStop(render::createGpuFlow(*device, render::floatingFlow(render::FloatingFlow::Pictures, 0)))},
                  {"of half of it", 1,
                   orStop(render::createGpuFlow(*device, render::floatingFlow(render::FloatingFlow::LastMean, 1)))}};
  for (int i = 0; i <= repeats; ++i)
    for (Flow& flow : flows) {
      wait();
      const auto start = std::chrono::steady_clock::now();
      orStop(flow.source->compute(colors[0].id(), colors[1].id(), kWidth >> flow.octaves, kHeight >> flow.octaves));
      waitFor(*device, flow.source->flow());
      const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
      if (i > 0) flow.times_ms.push_back(time.count());
    }
  double flow_ms[2];
  for (int k = 0; k < 2; ++k) {
    flow_ms[k] = median(flows[k].times_ms);
    std::printf("one flow %-18s %7.1f ms\n", flows[k].name, flow_ms[k]);
  }
  for (const int cameras_used : {3, 4}) {
    for (Lane& lane : lanes) {
      lane.times_ms.clear();
      lane.stage->setMethod(orStop(render::makeCameraMethod(*device, lane.method)));
    }
    for (int i = 0; i <= repeats; ++i)
      for (Lane& lane : lanes) {
        if (lane.new_picture) lane.stage->leaveOut({});
        wait();
        const auto start = std::chrono::steady_clock::now();
        orStop(lane.stage->draw(view, {.closest = cameras_used}, target.id()));
        wait();
        const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
        if (i > 0) lane.times_ms.push_back(time.count());  // the first one compiles programs
      }
    double ms[std::size(lanes)];
    for (size_t l = 0; l < std::size(lanes); ++l) ms[l] = median(lanes[l].times_ms);
    std::printf("%d cameras\n", cameras_used);
    for (size_t l = 0; l < std::size(lanes); ++l)
      std::printf("  %-16s %8.1f ms  %6.2f of fvvr  %5.2f of pairs\n", lanes[l].name, ms[l], ms[l] / ms[0],
                  ms[l] / ms[3]);
    const int n = cameras_used, pairs = n * (n - 1);
    const double short_pairs = ms[3] - pairs * (flow_ms[0] - flow_ms[1]);
    std::printf(
        "  flows: %.2f of the pairs; with flows of half the size, computed, the pairs would take %.1f ms, of which "
        "the star is %.2f\n",
        pairs * flow_ms[0] / ms[3], short_pairs, ms[2] / short_pairs);
  }
  return 0;
}

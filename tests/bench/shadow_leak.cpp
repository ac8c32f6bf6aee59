// SPDX-License-Identifier: Apache-2.0
// bench_shadow_leak CAPTURE [SEQUENCE FRAME [OUT.png]]: pixels that cameras texture through an occluder, by kind and
// size of the depth maps, on an arm in front of a body and on the capture's mesh; and the time of a depth map. OUT.png:
// the frame textured from one camera alone, other pixels left out: without depth maps, then with plain, offset and
// fattened small maps.
#include "render/shadow_leak.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "capture/capture.h"
#include "mattes/frame_reader.h"
#include "or_stop.h"
#include "platform/egl_context.h"
#include "platform/ffmpeg_video.h"
#include "platform/files.h"

namespace {

using namespace fourdvt;
using namespace fourdvt::testing;
using render::DepthMapOptions;
using render::Visibility;

constexpr int kRepeats = 20;

struct Case {
  const char* name;
  DepthMapOptions maps;
};

struct Scene {
  MeshTopology topology;
  Positions positions;
  std::vector<PinholeCamera> cameras, views;
};

// The seed's pictures were 320 x 240 (here upright) and their depth maps as large.
std::vector<Case> casesFor(double small) {
  return {{"no visibility", {Visibility::None, 1}},  {"plain, small", {Visibility::Plain, small}},
          {"plain", {Visibility::Plain, 1}},         {"offset draws, small", {Visibility::Offset, small}},
          {"offset draws", {Visibility::Offset, 1}}, {"fattened, small", {Visibility::Fattened, small}},
          {"fattened", {Visibility::Fattened, 1}}};
}

double depthMap_ms(gpu::Device& device, const Scene& scene, const DepthMapOptions& maps) {
  const auto fvvr = orStop(render::Fvvr::create(device, scene.cameras, scene.topology, maps));
  const std::vector<Image> pictures = [&] {
    std::vector<Image> out;
    for (const PinholeCamera& camera : scene.cameras) out.emplace_back(camera.width, camera.height, 4, 255);
    return out;
  }();
  orStop(fvvr->setFrame(scene.positions, pictures));
  // Draws a small picture that samples all maps, and waits until it is finished.
  const render::View small = render::viewFromCamera(scaledCamera(scene.views[0], 24, 32));
  const auto wait = [&] { orStop(fvvr->renderStill(small, {.samples = 0})); };
  wait();
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < kRepeats; ++k) fvvr->drawDepthMaps();
  wait();
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
  return taken.count() / kRepeats / double(scene.cameras.size());
}

void compare(gpu::Device& device, const char* title, const Scene& scene) {
  const double small = 240.0 / scene.cameras[0].width;
  std::printf("%s: %zu cameras of %dx%d, %zu views, %zu faces; small maps: %.0f x %.0f\n", title, scene.cameras.size(),
              scene.cameras[0].width, scene.cameras[0].height, scene.views.size(), scene.topology.face_vertices.size(),
              scene.cameras[0].width * small, scene.cameras[0].height * small);
  std::printf(
      "depth maps             hidden pixels   of them textured    seen pixels  of them not textured  ms a map\n");
  std::vector<ViewTruth> truths;
  for (const PinholeCamera& view : scene.views)
    for (const PinholeCamera& camera : scene.cameras)
      truths.push_back(truthOf(view, camera, scene.topology, scene.positions));
  for (const Case& one : casesFor(small)) {
    Leak sum;
    size_t next = 0;
    for (const PinholeCamera& view : scene.views)
      for (const PinholeCamera& camera : scene.cameras)
        sum += orStop(leakOf(device, view, camera, scene.topology, scene.positions, truths[next++], one.maps));
    std::printf("%-22s %13zu %10zu %6.2f %% %14zu %13zu %6.2f %% %8.2f\n", one.name, sum.hidden, sum.leaked,
                100.0 * double(sum.leaked) / double(sum.hidden), sum.seen, sum.lost,
                100.0 * double(sum.lost) / double(sum.seen), depthMap_ms(device, scene, one.maps));
  }
}

PinholeCamera orbiting(double azimuth_deg, double elevation_deg, const glm::dvec3& target, double distance_m) {
  OrbitView orbit;
  orbit.azimuth_deg = azimuth_deg, orbit.elevation_deg = elevation_deg;
  orbit.distance_m = distance_m, orbit.target_in_world = target;
  return cameraFromOrbit(orbit, 720, 960);
}

Scene armScene() {
  const ArmScene arm;
  Scene out{arm.topology, arm.positions, {}, {}};
  for (double azimuth : {-40.0, 0.0, 40.0}) out.cameras.push_back(orbiting(azimuth, 10, {0, 1, 0}, 3));
  for (double azimuth : {-70.0, -20.0, 25.0, 60.0}) out.views.push_back(orbiting(azimuth, 35, {0, 1, 0}, 2.5));
  return out;
}

struct CaptureScene : Scene {
  std::vector<Image> pictures;
};

CaptureScene captureScene(const char* folder, const char* sequence, uint32_t frame) {
  const OpenVideo open_video = [](const std::string& path, int channels) {
    return platform::openVideoFile(path, channels);
  };
  const auto capture = orStop(mattes::openCapture(folder, open_video, {sequence}));
  const auto reader = orStop(mattes::FrameReader::open(capture, capture.sequences[0], open_video, frame));
  auto captured = orStop(reader->next());
  CaptureScene out{{capture.topology, std::move(captured.positions), {}, {}}, std::move(captured.pictures)};
  for (const capture::CaptureCamera& camera : capture.cameras) out.cameras.push_back(camera.pinhole);
  glm::dvec3 middle(0);
  for (const glm::vec3& p : out.positions) middle += glm::dvec3(p) / double(out.positions.size());
  for (double azimuth : {20.0, 110.0, 200.0, 290.0}) out.views.push_back(orbiting(azimuth, 20, middle, 3.5));
  return out;
}

// Performer seen from 60 degrees beside the first camera, textured from that camera alone.
Image contactSheet(gpu::Device& device, const CaptureScene& scene) {
  glm::dvec3 middle(0);
  for (const glm::vec3& p : scene.positions) middle += glm::dvec3(p) / double(scene.positions.size());
  const glm::dvec3 side = scene.cameras[0].centreInWorld() - middle;
  const double azimuth_deg = glm::degrees(std::atan2(side.x, side.z)) + 60;
  const PinholeCamera view = orbiting(azimuth_deg, 15, middle, 3);
  const double small = 240.0 / scene.cameras[0].width;
  Image sheet;
  int column = 0;
  for (const DepthMapOptions& maps :
       {DepthMapOptions{Visibility::None, small}, DepthMapOptions{Visibility::Plain, small},
        DepthMapOptions{Visibility::Offset, small}, DepthMapOptions{Visibility::Fattened, small}}) {
    const auto fvvr = orStop(render::Fvvr::create(device, {&scene.cameras[0], 1}, scene.topology, maps));
    orStop(fvvr->setFrame(scene.positions, {&scene.pictures[0], 1}));
    const Image image =
        orStop(fvvr->renderStill(render::viewFromCamera(view), {.unseen = render::Unseen::Transparent}));
    if (sheet.pixels.empty()) sheet = Image(4 * image.width, image.height, 4);
    for (int y = 0; y < image.height; ++y)
      std::copy_n(image.at(0, y), size_t(image.width) * 4, sheet.at(column * image.width, y));
    ++column;
  }
  return sheet;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 && argc != 4 && argc != 5)
    return std::fprintf(stderr, "usage: bench_shadow_leak CAPTURE [SEQUENCE FRAME [OUT.png]]\n"), 2;
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  compare(*device, "arm before a body", armScene());
  const CaptureScene scene = captureScene(argv[1], argc > 3 ? argv[2] : "run", argc > 3 ? std::atoi(argv[3]) : 8);
  compare(*device, argv[1], scene);
  if (argc > 4) orStop(platform::writeImage(argv[4], contactSheet(*device, scene)));
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// bench_method_costs CAPTURE [SEQUENCE [REPEATS]]: cost of a new frame by every method that a bake may choose, relative
// to FVVR, on the capture's first surface, simplified and split to the sizes of the bake's table
// (native/bake/method/method_costs.inc). Prints that file's rows as measured; exits with 1 if an entry differs by more
// than 30 %. Surface and picture are new for every frame; 720 × 960, 4 cameras; alternating in one run, medians.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "bake/method/frame_drawing.h"
#include "bake/method/method_choice.h"
#include "capture/capture.h"
#include "encode/surfaces.h"
#include "mattes/frame_reader.h"
#include "or_stop.h"
#include "platform/egl_context.h"
#include "platform/ffmpeg_video.h"
#include "render/cameras/camera_method.h"

namespace {

using namespace fourdvt;
using fourdvt::testing::orStop;

constexpr int kWidth = 720, kHeight = 960;
constexpr double kOff = 0.3;

// Splits every triangle into four.
TriangleMesh split(const TriangleMesh& mesh) {
  TriangleMesh out{mesh.positions, {}};
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
  for (const glm::uvec3& f : mesh.faces) {
    glm::uvec3 m;
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = f[k], b = f[(k + 1) % 3];
      const auto [at, fresh] = middles.emplace(std::minmax(a, b), uint32_t(out.positions.size()));
      if (fresh) out.positions.push_back(0.5f * (mesh.positions[a] + mesh.positions[b]));
      m[k] = at->second;
    }
    out.faces.insert(out.faces.end(), {{f.x, m.x, m.z}, {f.y, m.y, m.x}, {f.z, m.z, m.y}, m});
  }
  return out;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: bench_method_costs CAPTURE [SEQUENCE [REPEATS]]\n"), 2;
  const std::string name = argc > 2 ? argv[2] : "run";
  const int repeats = argc > 3 ? std::max(1, std::atoi(argv[3])) : 3;
  const OpenVideo open_video = [](const std::string& path, int channels) {
    return platform::openVideoFile(path, channels);
  };
  const auto capture = orStop(mattes::openCapture(argv[1], open_video, {name}, capture::MeshNeed::AnySurface));
  const auto reader = orStop(mattes::FrameReader::open(capture, capture.sequences.at(0), open_video));
  const auto captured = orStop(reader->next());
  TriangleMesh given = orStop(capture::readSurfaceFrame(capture, capture.sequences.at(0), 0));
  std::vector<PinholeCamera> cameras;
  for (const capture::CaptureCamera& camera : capture.cameras) cameras.push_back(camera.pinhole);
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  const std::vector<std::string> methods = bake::methodCandidates();
  BoundingBox bounds{given.positions[0], given.positions[0]};
  for (const glm::vec3& p : given.positions) bounds = {glm::min(bounds.min, p), glm::max(bounds.max, p)};
  const PinholeCamera view = cameraFromOrbit(defaultOrbit(bounds, double(kWidth) / kHeight), kWidth, kHeight);
  std::printf("// %s\n", device->caps().renderer.c_str());
  std::map<std::string, std::vector<double>> ratios;
  bool off = false;
  for (const size_t faces : {size_t(2000), size_t(8000), size_t(32'000)}) {
    TriangleMesh surface = given;
    while (surface.faces.size() < faces) surface = split(surface);
    surface = encode::simplified(std::move(surface), faces);
    std::map<std::string, std::vector<double>> times_s;
    std::map<std::string, std::unique_ptr<bake::FrameDrawing>> drawings;
    for (const std::string& method : methods) {
      drawings[method] = orStop(bake::FrameDrawing::create(*device, cameras));
      drawings[method]->setMethod(orStop(render::makeCameraMethod(*device, method)));
    }
    for (int i = 0; i <= repeats; ++i)
      for (const std::string& method : methods) {
        bake::FrameDrawing& drawing = *drawings[method];
        orStop(drawing.setFrame(surface, captured.pictures));
        const auto start = std::chrono::steady_clock::now();
        orStop(drawing.render(view, {}));
        if (i > 0)  // the first one creates programs and targets
          times_s[method].push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      }
    for (const std::string& method : methods) {
      const double ratio = median(times_s[method]) / median(times_s[methods.front()]);
      ratios[method].push_back(ratio);
      const double stated = bake::methodCost(method, faces);
      if (std::abs(ratio / stated - 1) <= kOff) continue;
      off = true;
      std::fprintf(stderr, "%s at %zu faces: %.2f, the table has %.2f\n", method.c_str(), faces, ratio, stated);
    }
  }
  for (const std::string& method : methods)
    std::printf("    {\"%s\", {%.2f, %.2f, %.2f}},\n", method.c_str(), ratios[method][0], ratios[method][1],
                ratios[method][2]);
  return off ? 1 : 0;
}

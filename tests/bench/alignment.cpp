// SPDX-License-Identifier: Apache-2.0
// bench_alignment [VIEW_ERROR_MM [WRINKLES]]: blends two motions at equal weights whose textures are displaced by 3, 6
// and 12 mm; PSNR on the figure against the undisplaced texture in held-out views: plain blend, run-time flow in the
// picture as in 4DVT (OpenCV's Farnebäck, Eq. 7 corrected), baked alignment; error of the baked displacement, and its
// seconds per frame.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "../render/alignment_rig.h"
#include "or_stop.h"
#include "platform/egl_context.h"

namespace {

using namespace fourdvt;
using namespace fourdvt::testing;

cv::Mat matOf(Image& image) { return {image.height, image.width, CV_8UC4, image.pixels.data()}; }

// Luma over mid-grey, so that the background does not influence the flow.
cv::Mat lumaOf(Image& image) {
  cv::Mat luma, alpha;
  cv::cvtColor(matOf(image), luma, cv::COLOR_RGBA2GRAY);
  cv::extractChannel(matOf(image), alpha, 3);
  luma.setTo(128, alpha == 0);
  return luma;
}

// `picture` at p + share · flow(p).
cv::Mat warped(Image& picture, const cv::Mat& flow, float share) {
  cv::Mat map(flow.size(), CV_32FC2), out;
  for (int y = 0; y < flow.rows; ++y)
    for (int x = 0; x < flow.cols; ++x)
      map.at<cv::Vec2f>(y, x) = cv::Vec2f(float(x), float(y)) + share * flow.at<cv::Vec2f>(y, x);
  cv::remap(matOf(picture), out, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return out;
}

// Blend by 4DVT Eq. 7, corrected, at w = 1/2.
Image flowBlend(Image first, Image other) {
  cv::Mat flow;
  cv::calcOpticalFlowFarneback(lumaOf(first), lumaOf(other), flow, 0.5, 5, 15, 3, 5, 1.1,
                               cv::OPTFLOW_FARNEBACK_GAUSSIAN);
  Image out(first.width, first.height, 4);
  matOf(out) = 0.5 * warped(first, flow, -0.5f) + 0.5 * warped(other, flow, 0.5f);
  for (size_t i = 0; i < out.pixels.size(); i += 4)  // premultiplied → straight: no dark rim where warps reach outside
    for (int c = 0; c < 3; ++c)
      out.pixels[i + c] = uint8_t(std::min(255, out.pixels[i + c] * 255 / std::max<int>(out.pixels[i + 3], 1)));
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  const double view_error_m = argc > 1 ? std::atof(argv[1]) / 1000 : 0, wrinkles = argc > 2 ? std::atof(argv[2]) : 0;
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  const float half[] = {0.5f, 0.5f}, first[] = {1, 0}, other[] = {0, 1};
  AlignmentRig truth(*device, {.drift_m = 0});
  std::printf("%s, %u vertices, view error %.1f mm, wrinkles %.2f\n", device->caps().renderer.c_str(),
              truth.scene.mesh.topology.vertex_count, 1000 * view_error_m, wrinkles);
  std::printf("drift mm | none dB | picture flow dB | baked dB | perfect dB | rms error mm | s a frame | CPU s\n");
  for (const double drift_mm : {3.0, 6.0, 12.0}) {
    AlignmentRig rig(*device, {.drift_m = drift_mm / 1000, .view_error_m = view_error_m, .wrinkles = wrinkles});
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu_start = std::clock();
    const bake::AlignedFrame found = orStop(rig.align({}));
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double cpu_seconds = double(std::clock() - cpu_start) / CLOCKS_PER_SEC;
    SquaredError none, flow, baked, perfect;
    for (int view = 0; view < kHeldOutViews; ++view) {
      const PinholeCamera camera = rig.heldOutView(view);
      const Image wanted = truth.draw(camera, half, render::Align::None);
      none.add(wanted, rig.draw(camera, half, render::Align::None));
      flow.add(wanted,
               flowBlend(rig.draw(camera, first, render::Align::None), rig.draw(camera, other, render::Align::None)));
      rig.setAlignment(found.displacement_m);
      baked.add(wanted, rig.draw(camera, half, render::Align::Baked));
      rig.setAlignment(rig.scene.truth());
      perfect.add(wanted, rig.draw(camera, half, render::Align::Baked));
      rig.setAlignment({});
    }
    std::printf("%8.0f | %7.2f | %15.2f | %8.2f | %10.2f | %12.2f | %9.2f | %5.2f\n", drift_mm, none.psnr_db(),
                flow.psnr_db(), baked.psnr_db(), perfect.psnr_db(),
                1000 * alignmentError_m(rig.scene, found.displacement_m), seconds, cpu_seconds);
  }
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// fourdvt-opencv.js/.wasm: OpenCV's optical flow in the browser, a module of its own that a page loads when it needs
// it. a, b: luma, width × height bytes; out: 2 floats a pixel, x then y in row order, b(p + out) ~ a(p). 1: done, 0: it
// cannot. An option of 0 or left out is FlowOptions' default. Memory comes from fdvt_flow_alloc.
// An OpenCV error beyond that aborts the module.
#include "render/flow/flow.h"

#include <emscripten.h>

#include <cstdlib>
#include <opencv2/video/tracking.hpp>

#define FDVT extern "C" EMSCRIPTEN_KEEPALIVE

namespace {

constexpr int kLeastSide = 16;  // pixels; DIS needs a patch of 8 on its coarsest level

bool valid(const uint8_t* a, const uint8_t* b, int width, int height, const float* out) {
  return a && b && out && width >= kLeastSide && height >= kLeastSide;
}
cv::Mat picture(uint8_t* luma, int width, int height) { return {height, width, CV_8UC1, luma}; }

}  // namespace

FDVT void* fdvt_flow_alloc(uint32_t bytes) { return std::malloc(bytes); }
FDVT void fdvt_flow_free(void* p) { std::free(p); }

FDVT int fdvt_flow_farneback(uint8_t* a, uint8_t* b, int width, int height, float* out, int levels, int window,
                             int iterations, int poly_n, double poly_sigma) {
  if (!valid(a, b, width, height, out)) return 0;
  const fourdvt::render::FlowOptions defaults;
  const auto chosen = [](int value, int otherwise) { return value > 0 ? value : otherwise; };
  cv::Mat flow(height, width, CV_32FC2, out);
  cv::calcOpticalFlowFarneback(picture(a, width, height), picture(b, width, height), flow, 0.5,
                               chosen(levels, defaults.levels), chosen(window, defaults.window),
                               chosen(iterations, defaults.iterations), chosen(poly_n, defaults.poly_n),
                               poly_sigma > 0 ? poly_sigma : defaults.poly_sigma, 0);
  return 1;
}

FDVT int fdvt_flow_dis(uint8_t* a, uint8_t* b, int width, int height, float* out) {
  if (!valid(a, b, width, height, out)) return 0;
  static const cv::Ptr<cv::DISOpticalFlow> dis = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_ULTRAFAST);
  cv::Mat_<cv::Vec2f> flow;
  dis->calc(picture(a, width, height), picture(b, width, height), flow);
  flow.copyTo(cv::Mat(height, width, CV_32FC2, out));
  return 1;
}

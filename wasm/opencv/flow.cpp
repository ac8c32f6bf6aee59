// SPDX-License-Identifier: Apache-2.0
// fourdvt-opencv.js/.wasm: OpenCV's optical flow in the browser, with the options of the other flows. A separate
// module, loaded by a page on demand; parameters: abi.txt. An OpenCV error aborts the module.
#include "render/flow/flow.h"

#include <cstdlib>
#include <opencv2/video/tracking.hpp>

#include "abi.h"

namespace {

constexpr int kMinSide = 16;  // pixels

// Casts const away: cv::Mat has no read-only view.
cv::Mat picture(const uint8_t* luma, int width, int height) {
  return {height, width, CV_8UC1, const_cast<uint8_t*>(luma)};
}

}  // namespace

void* fdvt_flow_alloc(uint32_t size) { return std::malloc(size); }
void fdvt_flow_free(void* memory) { std::free(memory); }

int32_t fdvt_flow_farneback(const uint8_t* a, const uint8_t* b, int32_t width, int32_t height, float* flow) {
  if (width < kMinSide || height < kMinSide) return 0;
  const fourdvt::render::FlowOptions o;
  cv::Mat field(height, width, CV_32FC2, flow);
  cv::calcOpticalFlowFarneback(picture(a, width, height), picture(b, width, height), field, 0.5, o.levels, o.window,
                               o.iterations, o.poly_n, o.poly_sigma, 0);
  return 1;
}

// SPDX-License-Identifier: Apache-2.0
#include "edge/opencv_flow.h"

#include <opencv2/video/tracking.hpp>

#include "render/flow/flow.h"

namespace fourdvt::edge {
namespace {

Status solve(const render::FlowOptions& options, const cv::Mat& a, const cv::Mat& b, cv::Mat flow) try {
  if (options.method == render::FlowMethod::Dis) {
    cv::Mat_<cv::Vec2f> found;
    cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_ULTRAFAST)->calc(a, b, found);
    found.copyTo(flow);
  } else {
    cv::calcOpticalFlowFarneback(a, b, flow, 0.5, options.levels, options.window, options.iterations, options.poly_n,
                                 options.poly_sigma, 0);
  }
  return {};
} catch (const cv::Exception& problem) {
  return Error{ErrorId::InvalidArgument, std::string("OpenCV's optical flow refused the pictures: ") + problem.what()};
}

}  // namespace

std::unique_ptr<render::FlowSource> createOpencvFlow(gpu::Device& device, const render::FlowOptions& options) {
  return render::createReadBackFlow(
      device, [options](const uint8_t* a, const uint8_t* b, int width, int height, float* flow) {
        const auto picture = [&](const uint8_t* luma) {
          return cv::Mat(height, width, CV_8UC1, const_cast<uint8_t*>(luma));
        };
        return solve(options, picture(a), picture(b), cv::Mat(height, width, CV_32FC2, flow));
      });
}

}  // namespace fourdvt::edge

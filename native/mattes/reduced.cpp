// SPDX-License-Identifier: Apache-2.0
#include "mattes/reduced.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fourdvt::mattes {

int reductionFor(const capture::CaptureCamera& camera, double pixels) {
  return std::max(1, int(std::ceil(std::sqrt(double(camera.pinhole.width) * camera.pinhole.height / pixels))));
}

cv::Size reducedSize(int width, int height, int reduction) {
  return {std::max(1, width / reduction), std::max(1, height / reduction)};
}

capture::CaptureCamera reduced(const capture::CaptureCamera& camera, int reduction) {
  capture::CaptureCamera out = camera;
  PinholeCamera& p = out.pinhole;
  const cv::Size size = reducedSize(p.width, p.height, reduction);
  const double x = double(size.width) / p.width, y = double(size.height) / p.height;
  p.fx *= x, p.cx *= x, p.fy *= y, p.cy *= y;
  out.distortion.skew *= x;
  p.width = size.width, p.height = size.height;
  return out;
}

Image reduced(const Image& picture, int reduction) {
  if (reduction == 1) return picture;
  const cv::Size size = reducedSize(picture.width, picture.height, reduction);
  Image out(size.width, size.height, picture.channels);
  cv::Mat to = matrixOf(out);
  cv::resize(matrixOf(picture), to, size, 0, 0, cv::INTER_AREA);
  return out;
}

BackgroundModel reduced(const BackgroundModel& plates, int reduction) {
  if (reduction == 1) return plates;
  const cv::Size from(plates.width, plates.height), to = reducedSize(plates.width, plates.height, reduction);
  BackgroundModel out{to.width, to.height, plates.plates, {}, {}, {}};
  const auto shrink = [&](const std::vector<float>& values, int channels, std::vector<float>& result) {
    result.resize(size_t(to.area()) * size_t(channels));
    const cv::Mat in(from, CV_32FC(channels), const_cast<float*>(values.data()));
    cv::Mat target(to, CV_32FC(channels), result.data());
    cv::resize(in, target, to, 0, 0, cv::INTER_AREA);
  };
  shrink(plates.mean, 3, out.mean);
  shrink(plates.extra, 1, out.extra);
  if (!plates.known.empty()) {
    const cv::Mat known(from, CV_8U, const_cast<uint8_t*>(plates.known.data()));
    cv::Mat share;
    cv::resize(known * 255, share, to, 0, 0, cv::INTER_AREA);
    out.known.resize(size_t(to.area()));
    for (size_t i = 0; i < out.known.size(); ++i) out.known[i] = share.at<uint8_t>(int(i)) == 255;
  }
  return out;
}

cv::Mat resizedMask(const cv::Mat& mask, const cv::Size& size) {
  if (mask.size() == size) return mask.clone();
  cv::Mat out;
  cv::resize(mask, out, size, 0, 0, size.width > mask.cols ? cv::INTER_LINEAR : cv::INTER_AREA);
  return out >= 128;
}

}  // namespace fourdvt::mattes

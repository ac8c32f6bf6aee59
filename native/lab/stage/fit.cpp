// SPDX-License-Identifier: Apache-2.0
#include "lab/stage/fit.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace fourdvt::stage {
namespace {

cv::Mat viewOf(const Image& image) {
  return cv::Mat(image.height, image.width, CV_8UC(image.channels), const_cast<uint8_t*>(image.pixels.data()));
}

}  // namespace

Fit fitInto(int from_width, int from_height, int width, int height) {
  const double scale = std::min(double(width) / from_width, double(height) / from_height);
  Fit fit;
  fit.width = width;
  fit.height = height;
  fit.inner_width = std::clamp(int(std::lround(from_width * scale)), 1, width);
  fit.inner_height = std::clamp(int(std::lround(from_height * scale)), 1, height);
  fit.left = (width - fit.inner_width) / 2;
  fit.top = (height - fit.inner_height) / 2;
  return fit;
}

PinholeCamera fitted(const PinholeCamera& camera, const Fit& fit) {
  const double x = double(fit.inner_width) / camera.width, y = double(fit.inner_height) / camera.height;
  PinholeCamera out = camera;
  out.width = fit.width;
  out.height = fit.height;
  out.fx *= x;
  out.fy *= y;
  out.cx = camera.cx * x + fit.left;
  out.cy = camera.cy * y + fit.top;
  return out;
}

Image fitted(const Image& picture, const Fit& fit) {
  cv::Mat scaled;
  cv::resize(viewOf(picture), scaled, {fit.inner_width, fit.inner_height}, 0, 0, cv::INTER_AREA);
  Image out(fit.width, fit.height, picture.channels);
  cv::Mat whole = viewOf(out);
  cv::copyMakeBorder(scaled, whole, fit.top, fit.height - fit.inner_height - fit.top, fit.left,
                     fit.width - fit.inner_width - fit.left, cv::BORDER_REPLICATE);
  return out;
}

Image fitted(const Image& picture, const Fit& fit, const Image& beside) {
  Image out = beside;
  cv::Mat middle = viewOf(out)(cv::Rect(fit.left, fit.top, fit.inner_width, fit.inner_height));
  cv::resize(viewOf(picture), middle, middle.size(), 0, 0, cv::INTER_AREA);
  return out;
}

}  // namespace fourdvt::stage

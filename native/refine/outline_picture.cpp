// SPDX-License-Identifier: Apache-2.0
#include "refine/outline_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fourdvt::refine {
namespace {

constexpr int kScale = 2, kMargin = 12;  // pixels of the picture
constexpr float kAgree = 0.25f, kFull = 2, kDark = 0.6f;

cv::Scalar colourOf(float residual) {
  if (std::abs(residual) <= kAgree) return {40, 220, 60};
  const double share = std::min(1.0f, (std::abs(residual) - kAgree) / (kFull - kAgree));
  const double pale = 200 * (1 - share);
  return residual < 0 ? cv::Scalar(255, pale, 40) : cv::Scalar(40, pale, 255);
}

}  // namespace

Image outlinePicture(const Image& rgba, const PinholeCamera& camera, std::span<const OutlinePoint> points) {
  int left = rgba.width, top = rgba.height, right = 0, bottom = 0;
  for (int y = 0; y < rgba.height; ++y)
    for (int x = 0; x < rgba.width; ++x) {
      if (rgba.at(x, y)[3] < 128) continue;
      left = std::min(left, x - kMargin);
      right = std::max(right, x + kMargin);
      top = std::min(top, y - kMargin);
      bottom = y + kMargin;
    }
  left = std::max(0, left);
  top = std::max(0, top);
  right = std::min(rgba.width, right);
  bottom = std::min(rgba.height, bottom);
  if (right <= left || bottom <= top) return Image(2, 2, 3);
  const cv::Mat whole(rgba.height, rgba.width, CV_8UC4, const_cast<uint8_t*>(rgba.pixels.data()));
  cv::Mat part;
  cv::cvtColor(whole(cv::Rect(left, top, right - left, bottom - top)), part, cv::COLOR_RGBA2RGB);
  cv::resize(part, part, {}, kScale, kScale, cv::INTER_LINEAR);
  part *= kDark;
  for (const OutlinePoint& s : points) {
    const glm::vec3& p = s.point_in_cam;
    const double x = camera.fx * p.x / p.z + camera.cx - left, y = camera.fy * p.y / p.z + camera.cy - top;
    cv::circle(part, cv::Point(int(std::lround(x * kScale)), int(std::lround(y * kScale))), 1,
               colourOf(s.residual_pixels), cv::FILLED, cv::LINE_8);
  }
  Image out(part.cols, part.rows, 3);
  part.copyTo(cv::Mat(part.rows, part.cols, CV_8UC3, out.pixels.data()));
  return out;
}

Image beside(const Image& left, const Image& right) {
  Image out(left.width + right.width, left.height, 3);
  for (int y = 0; y < left.height; ++y) {
    std::copy_n(left.at(0, y), size_t(left.width) * 3, out.at(0, y));
    std::copy_n(right.at(0, y), size_t(right.width) * 3, out.at(left.width, y));
  }
  return out;
}

}  // namespace fourdvt::refine

// SPDX-License-Identifier: Apache-2.0
#include "bake/align/detail.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace fourdvt::bake {
namespace {

constexpr int kEdge = 4;  // pixels along the outline that do not count

cv::Mat lumaOf(const cv::Mat& rgba) {
  cv::Mat luma;
  cv::cvtColor(rgba, luma, cv::COLOR_RGBA2GRAY);
  luma.convertTo(luma, CV_32F);
  return luma;
}

cv::Mat insideOf(const cv::Mat& rgba) {
  cv::Mat alpha, inside;
  cv::extractChannel(rgba, alpha, 3);
  cv::erode(alpha == 255, inside, cv::getStructuringElement(cv::MORPH_RECT, {2 * kEdge + 1, 2 * kEdge + 1}), {-1, -1},
            1, cv::BORDER_CONSTANT, cv::Scalar(0));
  return inside;
}

double gradientEnergy(const cv::Mat& luma, const cv::Mat& inside) {
  const cv::Matx13f across(-0.5f, 0, 0.5f);
  cv::Mat x, y, energy;
  cv::filter2D(luma, x, CV_32F, across);
  cv::filter2D(luma, y, CV_32F, across.t());
  energy = x.mul(x) + y.mul(y);
  return cv::mean(energy, inside)[0] * cv::countNonZero(inside);
}

}  // namespace

void DetailCorrelation::add(const std::vector<cv::Mat>& looks) {
  const cv::Mat inside = insideOf(looks[0]);
  cv::Mat sum = cv::Mat::zeros(inside.size(), CV_32F);
  for (const cv::Mat& look : looks) {
    const cv::Mat luma = lumaOf(look);
    own_ += gradientEnergy(luma, inside);
    sum += luma;
  }
  sum_ += gradientEnergy(sum, inside);
  looks_ = looks.size();
}

float DetailCorrelation::value() const {
  if (own_ == 0) return 1;
  return static_cast<float>(std::clamp((sum_ - own_) / (own_ * double(looks_ - 1)), 0.0, 1.0));
}

}  // namespace fourdvt::bake

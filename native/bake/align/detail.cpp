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

DetailEnergy detailEnergy(const std::vector<cv::Mat>& looks) {
  const cv::Mat inside = insideOf(looks[0]);
  cv::Mat sum = cv::Mat::zeros(inside.size(), CV_32F);
  DetailEnergy energy;
  for (const cv::Mat& look : looks) {
    const cv::Mat luma = lumaOf(look);
    energy.own.push_back(gradientEnergy(luma, inside));
    sum += luma;
  }
  energy.sum = gradientEnergy(sum, inside);
  return energy;
}

float detailCorrelation(const std::vector<DetailEnergy>& views) {
  double own = 0, sum = 0;
  size_t looks = 2;
  for (const DetailEnergy& view : views) {
    for (const double energy : view.own) own += energy;
    sum += view.sum;
    looks = view.own.size();
  }
  if (own == 0) return 1;
  return static_cast<float>(std::clamp((sum - own) / (own * double(looks - 1)), 0.0, 1.0));
}

}  // namespace fourdvt::bake

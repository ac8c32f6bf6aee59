// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/matte_agreement.h"

#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace fourdvt::measure {
namespace {

// Mask of the matte: 255 at half coverage or more.
cv::Mat insideOf(const Image& picture) {
  cv::Mat out(picture.height, picture.width, CV_8U);
  const size_t pixels = size_t(picture.width) * picture.height, channels = size_t(picture.channels);
  for (size_t i = 0; i < pixels; ++i) out.data[i] = picture.pixels[channels * i + channels - 1] >= 128 ? 255 : 0;
  return out;
}

// Distance of each pixel's centre to the nearest non-zero pixel; far beyond the picture if there is none.
cv::Mat distanceTo(const cv::Mat& pixels) {
  cv::Mat out;
  cv::distanceTransform(pixels == 0, out, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return out;
}

// Boundary pixels of the matte: those with a neighbour outside; pixels beyond the picture count as inside.
cv::Mat edgeOf(const cv::Mat& inside) {
  cv::Mat eroded;
  cv::erode(inside, eroded, cv::getStructuringElement(cv::MORPH_CROSS, {3, 3}), {-1, -1}, 1, cv::BORDER_CONSTANT, 255);
  return inside & ~eroded;
}

double sumOver(const cv::Mat& pixels, const cv::Mat& values) {
  return cv::mean(values, pixels)[0] * cv::countNonZero(pixels);
}

}  // namespace

void MatteAgreement::add(const Image& picture, const Image& truth) {
  const cv::Mat matte = insideOf(picture), real = insideOf(truth);
  ++pictures_;
  all_.both += cv::countNonZero(matte & real);
  all_.either += cv::countNonZero(matte | real);
  // The edge runs along a pixel's border, half a pixel before the centre of its neighbour.
  const cv::Mat far = (distanceTo(real) > kBand_pixels + 0.5) | (distanceTo(~real) > kBand_pixels + 0.5);
  far_.both += cv::countNonZero(matte & real & far);
  far_.either += cv::countNonZero((matte | real) & far);
  const cv::Mat edge = edgeOf(matte), true_edge = edgeOf(real);
  if (cv::countNonZero(edge) == 0 || cv::countNonZero(true_edge) == 0) return;
  distance_ += sumOver(edge, distanceTo(true_edge)) + sumOver(true_edge, distanceTo(edge));
  edge_pixels_ += cv::countNonZero(edge) + cv::countNonZero(true_edge);
}

void MatteAgreement::add(const MatteAgreement& other) {
  pictures_ += other.pictures_;
  all_ = {all_.both + other.all_.both, all_.either + other.all_.either};
  far_ = {far_.both + other.far_.both, far_.either + other.far_.either};
  distance_ += other.distance_;
  edge_pixels_ += other.edge_pixels_;
}

double MatteAgreement::edgeDistance() const {
  return edge_pixels_ > 0 ? distance_ / edge_pixels_ : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace fourdvt::measure

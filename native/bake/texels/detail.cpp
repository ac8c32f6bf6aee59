// SPDX-License-Identifier: Apache-2.0
#include "bake/texels/detail.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fourdvt::bake {
namespace {

// Chosen on the sample's walk, at its held-out cameras (algorithms/texels.md).
constexpr double kRadius = 2.0 / 1024;  // standard deviation of the low-pass filter, sides of the layer
constexpr float kGain = 1.4f;           // compensates the blur of cameras, resampling and blending
constexpr float kAgrees = 0.2f;         // share of differing energy up to which a frame takes the mean detail,
constexpr float kDiffers = 0.5f;        // and from which on it keeps its own
constexpr float kNoise = 3;             // energy of a texel's noise, squared levels
const cv::Size kNeighbourhood(7, 7);    // texels over which energies are compared

cv::Mat matOf(const Image& layer) {
  return {layer.height, layer.width, CV_8UC3, const_cast<uint8_t*>(layer.pixels.data())};
}

// Values without detail, and what is missing from them.
struct Bands {
  cv::Mat low, detail;  // 8 bits; 16 bits, signed

  explicit Bands(const Image& layer) {
    const cv::Mat all = matOf(layer);
    cv::GaussianBlur(all, low, {}, std::max(0.5, kRadius * layer.width), 0, cv::BORDER_REPLICATE);
    cv::subtract(all, low, detail, {}, CV_16S);
  }
};

}  // namespace

void DetailMean::add(const Image& layer) {
  const Bands bands(layer);
  if (sum_.empty()) sum_ = cv::Mat::zeros(bands.detail.size(), CV_32SC3);
  cv::add(sum_, bands.detail, sum_, {}, CV_32S);
  ++frames_;
}

Image DetailMean::sharpened(const Image& layer) const {
  const Bands bands(layer);
  cv::Mat difference(sum_.size(), CV_32F), energy(sum_.size(), CV_32F), mean;
  sum_.convertTo(mean, CV_32F, 1.0 / frames_);
  for (int y = 0; y < sum_.rows; ++y) {
    for (int x = 0; x < sum_.cols; ++x) {
      const cv::Vec3f common = mean.at<cv::Vec3f>(y, x), own = bands.detail.at<cv::Vec3s>(y, x);
      difference.at<float>(y, x) = (own - common).dot(own - common);
      energy.at<float>(y, x) = own.dot(own) + common.dot(common);
    }
  }
  cv::boxFilter(difference, difference, -1, kNeighbourhood);
  cv::boxFilter(energy, energy, -1, kNeighbourhood);
  Image out(layer.width, layer.height, 3);
  for (int y = 0; y < sum_.rows; ++y) {
    for (int x = 0; x < sum_.cols; ++x) {
      const cv::Vec3f common = mean.at<cv::Vec3f>(y, x), own = bands.detail.at<cv::Vec3s>(y, x);
      const float disagreement = difference.at<float>(y, x) / (energy.at<float>(y, x) + kNoise);
      const float share = std::clamp((kDiffers - disagreement) / (kDiffers - kAgrees), 0.0f, 1.0f);
      const cv::Vec3f detail = own + share * (kGain * common - own);
      const cv::Vec3b low = bands.low.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c)
        out.at(x, y)[c] = static_cast<uint8_t>(std::clamp(low[c] + detail[c] + 0.5f, 0.0f, 255.0f));
    }
  }
  return out;
}

}  // namespace fourdvt::bake

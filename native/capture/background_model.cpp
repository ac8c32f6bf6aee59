// SPDX-License-Identifier: Apache-2.0
#include "capture/background_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "capture/gradient.h"
#include "capture/median.h"

namespace fourdvt::capture {
namespace {

constexpr float kShift_pixels = 0.1f;  // what a studio's cameras may shake
// A chroma key backdrop: its median colour's distance from grey in the CbCr plane of BT.709, levels of 255; the share
// of the plate that is that colour; and how far that share may stray from it, as shares of the distance: in hue, which
// light does not change, and in how much light there is.
constexpr float kBackdropChroma = 36, kBackdropShare = 0.7f, kBackdropHue = 0.1f, kBackdropLight = 0.6f;

// The variance between plates, averaged over 5 × 5 pixels, beyond what all pixels have (their median: sensor noise).
cv::Mat flicker(const std::vector<cv::Mat>& plates, const cv::Mat& mean) {
  cv::Mat sum = cv::Mat::zeros(mean.size(), CV_32F);
  for (const cv::Mat& plate : plates) {
    cv::Mat d, planes[3];
    cv::subtract(plate, mean, d, cv::noArray(), CV_32FC3);
    cv::split(d.mul(d), planes);
    sum += (planes[0] + planes[1] + planes[2]) / 3;
  }
  sum /= double(plates.size() - 1);
  cv::blur(sum, sum, {5, 5});
  const float noise = median({sum.begin<float>(), sum.end<float>()});
  // Two plates: the mean of 75 squares strays by a sixth. Half as much again is not noise.
  return cv::max(sum - 1.5 * noise, 0.0);
}

// The variance that a shift of kShift_pixels brings at the plates' edges.
cv::Mat shiftVariance(const cv::Mat& mean) { return kShift_pixels * kShift_pixels * squaredGradient(mean); }

// What a video's coarser chroma (4:2:0) changes where the plates, which are stored without it, change colour.
cv::Mat chromaVariance(const cv::Mat& mean) {
  cv::Mat luma, grey, colour, coarse, planes[3];
  cv::transform(mean, luma, cv::Matx13f(0.2126f, 0.7152f, 0.0722f));
  cv::merge(std::vector<cv::Mat>{luma, luma, luma}, grey);
  colour = mean - grey;
  cv::blur(colour, coarse, {3, 3});
  cv::Mat lost = colour - coarse;
  cv::split(lost.mul(lost), planes);
  cv::Mat sum = (planes[0] + planes[1] + planes[2]) / 3;
  cv::blur(sum, sum, {3, 3});
  return cv::max(sum - 3 * median({sum.begin<float>(), sum.end<float>()}), 0.0);
}

}  // namespace

cv::Mat squaredGradient(const cv::Mat& levels) {
  cv::Mat dx, dy, planes[3];
  cv::Sobel(levels, dx, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(levels, dy, CV_32F, 0, 1, 3, 0.125);
  cv::Mat squared = dx.mul(dx) + dy.mul(dy);
  cv::split(squared, planes);
  return cv::max(planes[0], cv::max(planes[1], planes[2]));
}

BackgroundModel makeBackgroundModel(std::span<const Image> plates) {
  assert(!plates.empty());
  BackgroundModel model{plates[0].width, plates[0].height, int(plates.size()), {}, {}};
  const cv::Size size(model.width, model.height);
  std::vector<cv::Mat> pictures;
  model.mean.resize(3 * size_t(size.area()));
  model.extra.resize(size_t(size.area()));
  cv::Mat mean(size, CV_32FC3, model.mean.data()), extra(size, CV_32F, model.extra.data());
  mean = 0;
  for (const Image& plate : plates) {
    assert(plate.channels == 3 && plate.width == model.width && plate.height == model.height);
    pictures.emplace_back(size, CV_8UC3, const_cast<uint8_t*>(plate.pixels.data()));
    cv::accumulate(pictures.back(), mean);
  }
  mean *= 1.0 / double(plates.size());
  cv::Mat sum = shiftVariance(mean) + chromaVariance(mean);
  if (plates.size() > 1) sum += flicker(pictures, mean);
  sum.copyTo(extra);
  return model;
}

Image meanPicture(const BackgroundModel& model) {
  Image out(model.width, model.height, 3);
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = static_cast<uint8_t>(std::lround(model.mean[i]));
  return out;
}

bool isChromaPlate(const Image& plate) {
  const size_t pixels = size_t(plate.width) * plate.height;
  std::vector<float> blue, red;
  for (size_t i = 0; i < pixels; ++i) {
    const uint8_t* p = &plate.pixels[3 * i];
    const float luma = 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2];
    blue.push_back((p[2] - luma) / 1.8556f);
    red.push_back((p[0] - luma) / 1.5748f);
  }
  const float cb = median(blue), cr = median(red), chroma = std::hypot(cb, cr);
  if (!(chroma >= kBackdropChroma)) return false;
  size_t alike = 0;
  for (size_t i = 0; i < pixels; ++i) {
    const float along = (blue[i] * cb + red[i] * cr) / chroma, across = (red[i] * cb - blue[i] * cr) / chroma;
    alike += std::abs(across) <= kBackdropHue * chroma && std::abs(along - chroma) <= kBackdropLight * chroma;
  }
  return double(alike) >= kBackdropShare * double(pixels);
}

}  // namespace fourdvt::capture

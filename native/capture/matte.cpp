// SPDX-License-Identifier: Apache-2.0
#include "capture/matte.h"

#include <cassert>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace fourdvt::capture {
namespace {

// Maps the difference of two RGB colours to their difference in the CbCr plane, which is linear.
float chromaDistance(const uint8_t* a, const uint8_t* b) {
  const float r = static_cast<float>(a[0]) - b[0], g = static_cast<float>(a[1]) - b[1],
              bl = static_cast<float>(a[2]) - b[2];
  const float luma = 0.2126f * r + 0.7152f * g + 0.0722f * bl;
  const float cb = (bl - luma) / 1.8556f, cr = (r - luma) / 1.5748f;
  return std::sqrt(cb * cb + cr * cr);
}

cv::Mat wrap(Image& image) { return cv::Mat(image.height, image.width, CV_8UC(image.channels), image.pixels.data()); }

}  // namespace

Image chromaKey(const Image& picture, const Image& plate, const ChromaKeyOptions& options) {
  assert(picture.channels == 3 && plate.channels == 3);
  assert(picture.width == plate.width && picture.height == plate.height);
  Image alpha(picture.width, picture.height, 1);
  const float scale = 255.0f / (options.foreground_above - options.background_below);
  for (size_t i = 0; i < alpha.pixels.size(); ++i) {
    const float distance = chromaDistance(&picture.pixels[i * 3], &plate.pixels[i * 3]);
    const float value = (distance - options.background_below) * scale;
    alpha.pixels[i] = static_cast<uint8_t>(std::lround(std::fmin(255.0f, std::fmax(0.0f, value))));
  }
  Image clean(picture.width, picture.height, 1);
  cv::Mat in = wrap(alpha), out = wrap(clean);
  const cv::Mat element = cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3});
  cv::morphologyEx(in, out, cv::MORPH_OPEN, element);
  cv::morphologyEx(out, out, cv::MORPH_CLOSE, element);
  return clean;
}

}  // namespace fourdvt::capture

// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/stereo/texture.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace fourdvt::reconstruct {
namespace {

constexpr int kDetail = 5, kAround = 9;  // pixels along each side: of the mean that details stand out from, around
constexpr int kOpaque = 250;             // of a matte
// Variances of the details, three channels together, levels of 255: of noise, and beyond it where half is believed.
constexpr float kTextureNoise = 6, kHalf = 12;

}  // namespace

std::vector<float> textureOf(const Image& rgba) {
  const cv::Mat picture(rgba.height, rgba.width, CV_8UC4, const_cast<uint8_t*>(rgba.pixels.data()));
  cv::Mat alpha, opaque, weight, colour, mean, share;
  cv::extractChannel(picture, alpha, 3);
  cv::erode(alpha >= kOpaque, opaque, cv::Mat(), {-1, -1}, 1, cv::BORDER_REPLICATE);
  opaque.convertTo(weight, CV_32F, 1 / 255.0);
  cv::cvtColor(picture, colour, cv::COLOR_BGRA2BGR);  // the order of colours does not matter
  colour.convertTo(colour, CV_32FC3);
  for (int i = 0; i < int(weight.total()); ++i) colour.at<cv::Vec3f>(i) *= weight.at<float>(i);
  cv::boxFilter(colour, mean, -1, {kDetail, kDetail});
  cv::boxFilter(weight, share, -1, {kDetail, kDetail});
  cv::Mat detail(weight.size(), CV_32F, cv::Scalar(0)), around, counted;
  for (int i = 0; i < int(weight.total()); ++i) {
    if (weight.at<float>(i) <= 0) continue;
    const cv::Vec3f from = colour.at<cv::Vec3f>(i) - mean.at<cv::Vec3f>(i) / share.at<float>(i);
    detail.at<float>(i) = from.dot(from);
  }
  cv::boxFilter(detail, around, -1, {kAround, kAround});
  cv::boxFilter(weight, counted, -1, {kAround, kAround});
  std::vector<float> out(weight.total(), 0);
  for (int i = 0; i < int(out.size()); ++i) {
    if (counted.at<float>(i) < 1e-4f) continue;
    const float above = std::max(around.at<float>(i) / counted.at<float>(i) - kTextureNoise, 0.0f);
    out[size_t(i)] = above / (above + kHalf);
  }
  return out;
}

void weighByTexture(const Image& rgba, DepthMap& map) {
  const std::vector<float> texture = textureOf(rgba);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const size_t i = size_t(y) * map.width + x;
      map.weight[i] *= texture[size_t(map.y + y) * rgba.width + map.x + x];
      if (map.weight[i] <= 0) map.depth_m[i] = 0;
    }
}

}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/shadow.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace fourdvt::studio {
namespace {

constexpr double kMapTexel_m = 0.002;

// Averages over a disc.
void softenBy(int radius_texels, cv::Mat& map) {
  const int side = 2 * radius_texels + 1;
  cv::Mat disc = cv::Mat::zeros(side, side, CV_32F);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      disc.at<float>(y, x) = std::hypot(x - radius_texels, y - radius_texels) <= radius_texels + 0.5;
  disc /= cv::sum(disc)[0];
  cv::Mat out;
  cv::filter2D(map, out, -1, disc, {-1, -1}, 0, cv::BORDER_CONSTANT);
  out.copyTo(map);
}

}  // namespace

Shadow::Shadow(const glm::dvec3& light, std::vector<glm::uvec3> faces, double penumbra_m)
    : light_(light),
      across_(glm::normalize(glm::cross(glm::dvec3(0, 1, 0), light))),
      along_(glm::cross(light, across_)),
      faces_(std::move(faces)),
      radius_texels_(int(std::lround(penumbra_m / kMapTexel_m))) {}

void Shadow::setPose(const Positions& pose) {
  std::vector<glm::dvec2> seen;
  glm::dvec2 low(1e9), high(-1e9);
  depth_m_ = 0;
  for (const glm::vec3& p : pose) {
    seen.emplace_back(glm::dot(glm::dvec3(p), across_), glm::dot(glm::dvec3(p), along_));
    low = glm::min(low, seen.back());
    high = glm::max(high, seen.back());
    depth_m_ += glm::dot(glm::dvec3(p), light_) / double(pose.size());
  }
  const int margin = 2 + radius_texels_;
  map_origin_m_ = low - margin * kMapTexel_m;
  map_ = Image(int((high.x - low.x) / kMapTexel_m) + 2 * margin + 1,
               int((high.y - low.y) / kMapTexel_m) + 2 * margin + 1, 1);
  cv::Mat out(map_.height, map_.width, CV_8U, map_.pixels.data());
  constexpr int kShift = 6;
  for (const glm::uvec3& f : faces_) {
    cv::Point corners[3];
    for (int k = 0; k < 3; ++k) {
      const glm::dvec2 texel = (seen[f[k]] - map_origin_m_) / kMapTexel_m - 0.5;
      corners[k] = {int(std::lround(texel.x * (1 << kShift))), int(std::lround(texel.y * (1 << kShift)))};
    }
    cv::fillConvexPoly(out, corners, 3, 255, cv::LINE_8, kShift);
  }
  if (radius_texels_ > 0) softenBy(radius_texels_, out);
}

double Shadow::shareAt(const glm::dvec3& point) const {
  if (map_.empty() || glm::dot(point, light_) < depth_m_) return 0;
  const glm::dvec2 texel =
      (glm::dvec2(glm::dot(point, across_), glm::dot(point, along_)) - map_origin_m_) / kMapTexel_m;
  if (!(texel.x >= 0 && texel.y >= 0 && texel.x < map_.width && texel.y < map_.height)) return 0;
  return *map_.at(int(texel.x), int(texel.y)) / 255.0;
}

}  // namespace fourdvt::studio

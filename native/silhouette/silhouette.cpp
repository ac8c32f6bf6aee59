// SPDX-License-Identifier: Apache-2.0
#include "silhouette/silhouette.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/glm.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace fourdvt::silhouette {
namespace {

constexpr int kMargin = 24;  // pixels
constexpr float kOutlineLevel = 127.5f, kStraight = 2.5f;
constexpr float kNowhereNear = 1e5f;  // value without an outline; less than kOutside

// Position between two neighbouring centres at which coverage equals kOutlineLevel, as a share of the way from `here`;
// 2 if there is none.
float crossing(float here, float there) {
  if ((here > kOutlineLevel) == (there > kOutlineLevel)) return 2;
  return (kOutlineLevel - here) / (there - here);
}

// Gradient of coverage by Sobel's operator; the picture is extended by its border pixels.
glm::vec2 gradient(const Image& coverage, int x, int y) {
  const auto at = [&](int u, int v) {
    return float(*coverage.at(std::clamp(u, 0, coverage.width - 1), std::clamp(v, 0, coverage.height - 1)));
  };
  glm::vec2 sum(0);
  for (int k = -1; k <= 1; ++k) {
    const float weight = k == 0 ? 2 : 1;
    sum.x += weight * (at(x + 1, y + k) - at(x - 1, y + k));
    sum.y += weight * (at(x + k, y + 1) - at(x + k, y - 1));
  }
  return sum;
}

// Point on the outline, with the unit normal towards the performer.
struct Foot {
  glm::vec2 at{0}, normal{0};
};

// Outline point near a pixel's centre, if the outline passes between it and a neighbour: the crossing on the row or the
// column, whichever is nearer along the normal.
std::optional<Foot> footBeside(const Image& coverage, int x, int y) {
  const float here = *coverage.at(x, y);
  std::optional<glm::vec2> nearest;
  glm::vec2 normal(0);
  const int steps[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  for (const auto& [dx, dy] : steps) {
    const int u = x + dx, v = y + dy;
    if (u < 0 || v < 0 || u >= coverage.width || v >= coverage.height) continue;
    const float share = crossing(here, *coverage.at(u, v));
    if (share > 1) continue;
    const glm::vec2 to = share * glm::vec2(dx, dy);
    if (nearest && glm::length(to) >= glm::length(*nearest)) continue;
    nearest = to;
    normal = glm::vec2(dx, dy) * (here > kOutlineLevel ? -1.0f : 1.0f);
  }
  if (!nearest) return std::nullopt;
  const glm::vec2 slope = gradient(coverage, x, y);
  if (glm::dot(slope, normal) > 0) normal = glm::normalize(slope);
  return Foot{normal * glm::dot(normal, *nearest), normal};
}

cv::Rect boundsOf(const Image& coverage, size_t& inside) {
  int left = coverage.width, top = coverage.height, right = -1, bottom = -1;
  inside = 0;
  for (int y = 0; y < coverage.height; ++y)
    for (int x = 0; x < coverage.width; ++x) {
      if (*coverage.at(x, y) <= kOutlineLevel) continue;
      ++inside;
      left = std::min(left, x);
      right = std::max(right, x);
      top = std::min(top, y);
      bottom = y;
    }
  left = std::max(0, left - kMargin);
  top = std::max(0, top - kMargin);
  right = std::min(coverage.width - 1, right + kMargin);
  bottom = std::min(coverage.height - 1, bottom + kMargin);
  return {left, top, right - left + 1, bottom - top + 1};
}

}  // namespace

SilhouetteDistance::SilhouetteDistance(const Image& coverage) : width_(coverage.width), height_(coverage.height) {
  assert(coverage.channels == 1);
  size_t inside = 0;
  const cv::Rect kept = boundsOf(coverage, inside);
  empty_ = inside == 0;
  full_ = inside == coverage.pixels.size();
  if (empty_ || full_) return;
  left_ = kept.x, top_ = kept.y, columns_ = kept.width, rows_ = kept.height;
  pixels_.assign(size_t(columns_) * rows_, 0);

  // Pixels beside the outline have an outline point of their own; all others use that of the nearest such pixel.
  cv::Mat beside(rows_, columns_, CV_8U, cv::Scalar(255)), labels, way;
  std::vector<Foot> feet(pixels_.size());
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      const auto foot = footBeside(coverage, x + left_, y + top_);
      if (!foot) continue;
      feet[size_t(y) * columns_ + x] = {glm::vec2(x, y) + foot->at, foot->normal};
      beside.at<uint8_t>(y, x) = 0;
    }
  cv::distanceTransform(beside, way, labels, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<Foot> of_label;
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      if (beside.at<uint8_t>(y, x) != 0) continue;
      const auto label = size_t(labels.at<int>(y, x));
      if (of_label.size() <= label) of_label.resize(label + 1);
      of_label[label] = feet[size_t(y) * columns_ + x];
    }
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      const Foot& foot = of_label[size_t(labels.at<int>(y, x))];
      const glm::vec2 to = foot.at - glm::vec2(x, y);
      // Near the outline: distance to its tangent; farther away: distance to the point.
      const float distance = way.at<float>(y, x) <= kStraight ? std::abs(glm::dot(to, foot.normal)) : glm::length(to);
      pixels_[size_t(y) * columns_ + x] = *coverage.at(x + left_, y + top_) > kOutlineLevel ? distance : -distance;
    }
}

float SilhouetteDistance::at(double x, double y) const {
  if (x < 0 || y < 0 || x > width_ || y > height_) return kOutside;
  if (pixels_.empty()) return full_ ? kNowhereNear : -kNowhereNear;
  // The picture ends half a pixel beyond its outermost centres; positions are clamped to the centres.
  const double u = std::clamp(x - 0.5, 0.0, width_ - 1.0) - left_, v = std::clamp(y - 0.5, 0.0, height_ - 1.0) - top_;
  const double inner_u = std::clamp(u, 0.0, columns_ - 1.0), inner_v = std::clamp(v, 0.0, rows_ - 1.0);
  const int i = std::min(int(inner_u), std::max(0, columns_ - 2)), j = std::min(int(inner_v), std::max(0, rows_ - 2));
  const auto s = float(inner_u - i), t = float(inner_v - j);
  const float* row = &pixels_[size_t(j) * columns_ + i];
  const int right = columns_ > 1 ? 1 : 0, below = rows_ > 1 ? columns_ : 0;
  const float value =
      (row[0] * (1 - s) + row[right] * s) * (1 - t) + (row[below] * (1 - s) + row[below + right] * s) * t;
  if (u == inner_u && v == inner_v) return value;
  const auto beyond = float(std::hypot(u - inner_u, v - inner_v));
  // Lower bound: the outline lies at least the margin inside the stored part, and distances are 1-Lipschitz.
  const double far_u = std::max({kMargin - u, u - (columns_ - 1 - kMargin), 0.0});
  const double far_v = std::max({kMargin - v, v - (rows_ - 1 - kMargin), 0.0});
  return std::min(value + beyond, -float(std::hypot(far_u, far_v)));
}

}  // namespace fourdvt::silhouette

// SPDX-License-Identifier: Apache-2.0
#include "live/camera/outline_message.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "silhouette/contour.h"

namespace fourdvt::live {
namespace {

constexpr uint8_t kCovered = 0x80;      // bit that is set in coverages above one half
constexpr double kToleranceStep = 1.5;  // growth factor of the tolerance
constexpr int kQualityStep = 15;
constexpr size_t kMaxJpegBytes = kMaxCameraMessageBytes - (64u << 10);  // leaves room for the rings

package::Rect wholeOr(const package::Rect& region, const Image& image) {
  if (region.width == 0) return {0, 0, image.width, image.height};
  const int x = std::min(region.x, image.width), y = std::min(region.y, image.height);
  return {x, y, std::min(region.x + region.width, image.width) - x,
          std::min(region.y + region.height, image.height) - y};
}

size_t pointsOf(const silhouette::Outline& outline) {
  size_t points = 0;
  for (const auto& ring : outline.rings) points += ring.size();
  return points;
}

void keepLargest(std::vector<silhouette::Ring>& rings) {
  if (rings.size() <= kMaxRings) return;
  std::stable_sort(rings.begin(), rings.end(), [](const auto& a, const auto& b) {
    return std::abs(silhouette::signedArea_px2(a)) > std::abs(silhouette::signedArea_px2(b));
  });
  rings.resize(kMaxRings);
}

}  // namespace

void keepRegion(const package::Rect& region, Image& coverage) {
  const package::Rect kept = wholeOr(region, coverage);
  for (int y = 0; y < coverage.height; ++y) {
    uint8_t* row = coverage.at(0, y);
    const bool outside = y < kept.y || y >= kept.y + kept.height;
    std::fill_n(row, outside ? coverage.width : kept.x, uint8_t(0));
    if (!outside) std::fill(row + kept.x + kept.width, row + coverage.width, uint8_t(0));
  }
}

package::Rect cropOf(const Image& coverage, const package::Rect& region) {
  std::vector<uint8_t> columns(size_t(coverage.width), 0);
  int top = coverage.height, bottom = -1;
  for (int y = 0; y < coverage.height; ++y) {
    const uint8_t* row = coverage.at(0, y);
    uint8_t any = 0;
    for (int x = 0; x < coverage.width; ++x) {
      columns[size_t(x)] |= row[x];
      any |= row[x];
    }
    if (any & kCovered) top = std::min(top, y), bottom = y;
  }
  if (bottom < 0) return {};
  const auto covered = [](uint8_t c) { return (c & kCovered) != 0; };
  const int left = int(std::find_if(columns.begin(), columns.end(), covered) - columns.begin());
  const int right = int(columns.rend() - std::find_if(columns.rbegin(), columns.rend(), covered)) - 1;
  const package::Rect all = wholeOr(region, coverage);
  const int x0 = std::max(left - kCropMargin_px, all.x) & ~1, y0 = std::max(top - kCropMargin_px, all.y) & ~1;
  const int x1 = std::min({(right + kCropMargin_px + 2) & ~1, (all.x + all.width + 1) & ~1, coverage.width});
  const int y1 = std::min({(bottom + kCropMargin_px + 2) & ~1, (all.y + all.height + 1) & ~1, coverage.height});
  return {x0, y0, x1 - x0, y1 - y0};
}

std::vector<Ring16> ringsOf(const Image& coverage, double tolerance_px) {
  silhouette::OutlineRules rules;
  rules.tolerance_px = 0;
  rules.steps_per_px = int(kPointsPerPixel);
  const silhouette::Outline whole = silhouette::outlineOf(coverage, rules);
  silhouette::Outline outline;
  for (tolerance_px = std::max(tolerance_px, 0.25 / kPointsPerPixel);; tolerance_px *= kToleranceStep) {
    outline = whole;
    keepLargest(outline.rings);
    silhouette::simplifyRings(outline.rings, tolerance_px);
    if (pointsOf(outline) <= kMaxRingPoints) break;
  }
  std::vector<Ring16> out;
  for (const auto& ring : outline.rings) {
    Ring16& sent = out.emplace_back();
    for (const glm::dvec2& p : ring)
      sent.push_back({uint16_t(std::lround(p.x * kPointsPerPixel)), uint16_t(std::lround(p.y * kPointsPerPixel))});
  }
  return out;
}

std::vector<uint8_t> jpegOf(const Image& rgb, const package::Rect& crop, int quality) {
  const cv::Mat whole(rgb.height, rgb.width, CV_8UC3, const_cast<uint8_t*>(rgb.pixels.data()));
  cv::Mat bgr;
  cv::cvtColor(whole(cv::Rect(crop.x, crop.y, crop.width, crop.height)), bgr, cv::COLOR_RGB2BGR);
  std::vector<uint8_t> out;
  do {
    cv::imencode(".jpg", bgr, out, {cv::IMWRITE_JPEG_QUALITY, std::max(1, quality)});
    quality -= kQualityStep;
  } while (out.size() > kMaxJpegBytes && quality > 0);
  return out;
}

}  // namespace fourdvt::live

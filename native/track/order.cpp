// SPDX-License-Identifier: Apache-2.0
#include "track/order.h"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "base/opencv_image.h"
#include "base/parallel.h"

namespace fourdvt::track {
namespace {

constexpr int kSide = 96;  // pixels, the longer side of a thumbnail

}  // namespace

FrameThumbnails thumbnailsOf(std::span<const Image> pictures) {
  FrameThumbnails out;
  out.pictures.resize(pictures.size());
  inParallel(pictures.size(), [&](size_t c) {
    const Image& picture = pictures[c];
    const cv::Mat rgba = matrixOf(picture);
    const double factor = double(kSide) / std::max(picture.width, picture.height);
    cv::Mat alpha, colours;
    cv::extractChannel(rgba, alpha, 3);
    if (cv::countNonZero(alpha >= 128) == 0) return;
    rgba.copyTo(colours, alpha >= 128);
    cv::resize(colours, out.pictures[c], {}, factor, factor, cv::INTER_AREA);
  });
  return out;
}

double dissimilarity(const FrameThumbnails& a, const FrameThumbnails& b) {
  double sum = 0, area = 0;
  for (size_t c = 0; c < a.pictures.size(); ++c) {
    if (a.pictures[c].empty() || b.pictures[c].empty()) continue;
    // Sums over all four channels: outlines by alpha, and what lies inside by colour.
    sum += cv::norm(a.pictures[c], b.pictures[c], cv::NORM_L1);
    cv::Mat common;
    cv::max(a.pictures[c], b.pictures[c], common);
    area += cv::norm(common, cv::NORM_L1);
  }
  return area > 0 ? sum / area : 1;
}

std::vector<TrackingStep> trackingOrder(std::span<const FrameThumbnails> frames, uint32_t root) {
  const size_t count = frames.size();
  std::vector<double> best(count, std::numeric_limits<double>::infinity());
  std::vector<TrackingStep> steps, candidates(count);
  std::vector<bool> done(count, false);
  std::vector<uint32_t> depths(count, 0);
  best[root] = 0;
  candidates[root] = {root, root, 0, 0};
  for (size_t i = 0; i < count; ++i) {
    uint32_t next = root;
    double least = std::numeric_limits<double>::infinity();
    for (uint32_t f = 0; f < count; ++f)
      if (!done[f] && best[f] < least) next = f, least = best[f];
    done[next] = true;
    const uint32_t depth = next == root ? 0 : depths[candidates[next].parent] + 1;
    depths[next] = candidates[next].depth = depth;
    steps.push_back(candidates[next]);
    for (uint32_t f = 0; f < count; ++f) {
      if (done[f]) continue;
      const double d = dissimilarity(frames[next], frames[f]);
      if (d * d < best[f]) best[f] = d * d, candidates[f] = {f, next, d, 0};
    }
  }
  return steps;
}

}  // namespace fourdvt::track

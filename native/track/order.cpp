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

namespace {

constexpr double kNeighbour = 1.3;  // largest dissimilarity of neighbours, relative to the nearest one

// [frame] of a minimum spanning tree, from the root outwards; the root's is the root.
std::vector<uint32_t> spanningParents(const std::vector<std::vector<double>>& apart, uint32_t root) {
  const auto count = uint32_t(apart.size());
  std::vector<double> best(count, std::numeric_limits<double>::infinity());
  std::vector<uint32_t> parents(count, root);
  std::vector<bool> done(count, false);
  best[root] = 0;
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t next = root;
    double least = std::numeric_limits<double>::infinity();
    for (uint32_t f = 0; f < count; ++f)
      if (!done[f] && best[f] < least) next = f, least = best[f];
    done[next] = true;
    for (uint32_t f = 0; f < count; ++f)
      if (!done[f] && apart[next][f] < best[f]) best[f] = apart[next][f], parents[f] = next;
  }
  return parents;
}

}  // namespace

std::vector<TrackingStep> trackingOrder(std::span<const FrameThumbnails> frames, uint32_t root) {
  const auto count = uint32_t(frames.size());
  std::vector<std::vector<double>> apart(count, std::vector<double>(count, 0));
  inParallel(count, [&](size_t a) {
    for (size_t b = 0; b < a; ++b) apart[a][b] = dissimilarity(frames[a], frames[b]);
  });
  std::vector<double> nearest(count, std::numeric_limits<double>::infinity());
  for (uint32_t a = 0; a < count; ++a)
    for (uint32_t b = 0; b < a; ++b) {
      apart[b][a] = apart[a][b];
      nearest[a] = std::min(nearest[a], apart[a][b]);
      nearest[b] = std::min(nearest[b], apart[a][b]);
    }
  const std::vector<uint32_t> spanning = spanningParents(apart, root);
  const auto joined = [&](uint32_t a, uint32_t b) {
    return spanning[a] == b || spanning[b] == a || apart[a][b] <= kNeighbour * std::max(nearest[a], nearest[b]);
  };
  // Shortest paths over these edges, squared.
  std::vector<double> best(count, std::numeric_limits<double>::infinity());
  std::vector<TrackingStep> steps, candidates(count);
  std::vector<bool> done(count, false);
  best[root] = 0;
  candidates[root] = {root, root, 0, 0};
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t next = root;
    double least = std::numeric_limits<double>::infinity();
    for (uint32_t f = 0; f < count; ++f)
      if (!done[f] && best[f] < least) next = f, least = best[f];
    done[next] = true;
    steps.push_back(candidates[next]);
    for (uint32_t f = 0; f < count; ++f) {
      if (done[f] || !joined(next, f)) continue;
      const double d = apart[next][f], length = best[next] + d * d;
      if (length < best[f]) best[f] = length, candidates[f] = {f, next, d, candidates[next].depth + 1};
    }
  }
  return steps;
}

}  // namespace fourdvt::track

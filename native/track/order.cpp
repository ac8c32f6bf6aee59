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

constexpr double kNoEdge = std::numeric_limits<double>::infinity();
constexpr double kNeighbour = 1.3;  // largest dissimilarity of neighbours, relative to the nearest one

// Tree that grows from the root by the open frame of least length (Prim, Dijkstra). length(length of a, a, b): length
// of frame b if it is reached from a, a frame of the tree; infinite if no edge joins them.
template <class Length>
std::vector<TrackingStep> grownTree(const std::vector<std::vector<double>>& apart, uint32_t root, Length length) {
  const auto count = uint32_t(apart.size());
  std::vector<double> best(count, kNoEdge);
  std::vector<TrackingStep> steps, candidates(count);
  std::vector<bool> done(count, false);
  best[root] = 0;
  candidates[root] = {root, root, 0, 0};
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t next = root;
    double least = kNoEdge;
    for (uint32_t f = 0; f < count; ++f)
      if (!done[f] && best[f] < least) next = f, least = best[f];
    done[next] = true;
    steps.push_back(candidates[next]);
    for (uint32_t f = 0; f < count; ++f) {
      const double found = done[f] ? kNoEdge : length(best[next], next, f);
      if (found < best[f]) best[f] = found, candidates[f] = {f, next, apart[next][f], candidates[next].depth + 1};
    }
  }
  return steps;
}

}  // namespace

std::vector<TrackingStep> trackingOrder(std::span<const FrameThumbnails> frames, uint32_t root) {
  const auto count = uint32_t(frames.size());
  std::vector<std::vector<double>> apart(count, std::vector<double>(count, 0));
  inParallel(count, [&](size_t a) {
    for (size_t b = 0; b < a; ++b) apart[a][b] = dissimilarity(frames[a], frames[b]);
  });
  std::vector<double> nearest(count, kNoEdge);
  for (uint32_t a = 0; a < count; ++a)
    for (uint32_t b = 0; b < a; ++b) {
      apart[b][a] = apart[a][b];
      nearest[a] = std::min(nearest[a], apart[a][b]);
      nearest[b] = std::min(nearest[b], apart[a][b]);
    }
  // Parents in a minimum spanning tree.
  std::vector<uint32_t> spanning(count, root);
  for (const TrackingStep& step : grownTree(apart, root, [&](double, uint32_t a, uint32_t b) { return apart[a][b]; }))
    spanning[step.frame] = step.parent;
  return grownTree(apart, root, [&](double length, uint32_t a, uint32_t b) {
    const bool joined =
        spanning[a] == b || spanning[b] == a || apart[a][b] <= kNeighbour * std::max(nearest[a], nearest[b]);
    return joined ? length + apart[a][b] * apart[a][b] : kNoEdge;
  });
}

}  // namespace fourdvt::track

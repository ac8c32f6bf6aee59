// SPDX-License-Identifier: Apache-2.0
#include "capture/matte_cut.h"

#include <algorithm>
#include <cstring>
#include <opencv2/imgproc/detail/gcgraph.hpp>
#include <vector>

namespace fourdvt::capture {

cv::Mat cheapestCut(const CutCosts& costs, const cv::Mat& given, const cv::Mat& open) {
  cv::Mat node(open.size(), CV_32S, cv::Scalar(-1)), out = given.clone();
  const int count = cv::countNonZero(open);
  if (count == 0) return out;
  cv::detail::GCGraph<float> graph(static_cast<unsigned>(count), static_cast<unsigned>(8 * count));
  std::vector<float> balance;  // above 0: towards the background
  balance.reserve(size_t(count));
  for (int y = 0; y < open.rows; ++y)
    for (int x = 0; x < open.cols; ++x)
      if (open.at<uint8_t>(y, x)) {
        node.at<int>(y, x) = graph.addVtx();
        balance.push_back(costs.object_minus_background.at<float>(y, x));
      }
  const auto edge = [&](int x, int y, int dx, int dy, const cv::Mat& weights) {
    if (x + dx < 0 || x + dx >= open.cols || y + dy >= open.rows) return;
    const int a = node.at<int>(y, x), b = node.at<int>(y + dy, x + dx);
    const float w = weights.at<float>(y, x);
    if (a >= 0 && b >= 0) graph.addEdges(a, b, w, w);
    if (a >= 0 && b < 0) balance[size_t(a)] += given.at<uint8_t>(y + dy, x + dx) ? -w : w;
    if (b >= 0 && a < 0) balance[size_t(b)] += given.at<uint8_t>(y, x) ? -w : w;
  };
  for (int y = 0; y < open.rows; ++y)
    for (int x = 0; x < open.cols; ++x) {
      edge(x, y, 1, 0, costs.right);
      edge(x, y, 0, 1, costs.down);
      edge(x, y, 1, 1, costs.down_right);
      edge(x, y, -1, 1, costs.down_left);
    }
  // A vertex on the source's side is object.
  for (int i = 0; i < count; ++i)
    graph.addTermWeights(i, std::max(0.0f, -balance[size_t(i)]), std::max(0.0f, balance[size_t(i)]));
  graph.maxFlow();
  for (int y = 0; y < open.rows; ++y)
    for (int x = 0; x < open.cols; ++x)
      if (node.at<int>(y, x) >= 0) out.at<uint8_t>(y, x) = graph.inSourceSegment(node.at<int>(y, x)) ? 255 : 0;
  return out;
}

}  // namespace fourdvt::capture

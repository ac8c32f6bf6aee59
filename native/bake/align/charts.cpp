// SPDX-License-Identifier: Apache-2.0
#include "bake/align/charts.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

namespace fourdvt::bake {
namespace {

constexpr int kNoChart = -1;

// Connected components of faces that share texture vertices.
std::vector<int> chartsOf(const MeshTopology& topology) {
  std::vector<int> parent(topology.uvs.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const glm::uvec3& face : topology.face_uvs) {
    parent[root(int(face.y))] = root(int(face.x));
    parent[root(int(face.z))] = root(int(face.x));
  }
  std::vector<int> chart(parent.size());
  for (size_t uv = 0; uv < chart.size(); ++uv) chart[uv] = root(int(uv));
  return chart;
}

// CV_32S: chart + 1 of covered texels, 0 elsewhere.
cv::Mat drawCharts(const MeshTopology& topology, const std::vector<int>& chart_of_uv, int size) {
  constexpr int kFractionBits = 4;
  cv::Mat charts(size, size, CV_32S, cv::Scalar(0));
  for (const glm::uvec3& face : topology.face_uvs) {
    cv::Point corners[3];
    for (int corner = 0; corner < 3; ++corner) {
      const glm::vec2 texel = (topology.uvs[face[corner]] * float(size) - 0.5f) * float(1 << kFractionBits);
      corners[corner] = {int(std::lround(texel.x)), int(std::lround(texel.y))};
    }
    cv::fillConvexPoly(charts, corners, 3, cv::Scalar(chart_of_uv[face.x] + 1), cv::LINE_8, kFractionBits);
  }
  return charts;
}

}  // namespace

ChartLimits::ChartLimits(const MeshTopology& topology, const SurfaceFrames& frames, int size, int gutter_texels)
    : topology_(&topology), frames_(&frames), size_(size), chart_of_uv_(chartsOf(topology)) {
  const cv::Mat charts = drawCharts(topology, chart_of_uv_, size);
  cv::Mat distance, nearest;
  cv::distanceTransform(charts == 0, distance, nearest, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<int> chart_of_label(1, kNoChart);  // labels of covered texels count from 1, in any order
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      if (charts.at<int>(y, x) == 0) continue;
      const size_t label = size_t(nearest.at<int>(y, x));
      if (label >= chart_of_label.size()) chart_of_label.resize(label + 1, kNoChart);
      chart_of_label[label] = charts.at<int>(y, x) - 1;
    }
  reach_.assign(size_t(size) * size, kNoChart);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const size_t label = size_t(nearest.at<int>(y, x));
      if (distance.at<float>(y, x) <= float(gutter_texels) && label < chart_of_label.size())
        reach_[size_t(y) * size + x] = chart_of_label[label];
    }
}

float ChartLimits::allowedShare(const glm::vec2& uv, const glm::vec2& shift, int chart) const {
  const int steps = int(std::ceil(glm::length(shift) * float(size_)));  // at most a texel each
  for (int step = 1; step <= steps; ++step) {
    const glm::vec2 texel = glm::floor((uv + shift * (float(step) / float(steps))) * float(size_));
    const glm::ivec2 at(glm::clamp(texel, glm::vec2(0), glm::vec2(float(size_ - 1))));
    // The thin end of a chart may cover no texel centre: texels of no chart count as its own within one texel.
    if (reach_[size_t(at.y) * size_ + at.x] != chart && step > 1) return float(step - 1) / float(steps);
  }
  return 1;
}

void ChartLimits::cut(std::vector<glm::vec2>& displacement_m) const {
  std::vector<float> share(displacement_m.size(), 1.0f);
  for (uint32_t face = 0; face < topology_->faceCount(); ++face)
    for (int corner = 0; corner < 3; ++corner) {
      const uint32_t vertex = topology_->face_vertices[face][corner], uv = topology_->face_uvs[face][corner];
      const glm::vec2 shift = frames_->uv_from_tangents[3 * face + corner] * displacement_m[vertex];
      for (const float sign : {-1.0f, 1.0f})
        share[vertex] = std::min(share[vertex], allowedShare(topology_->uvs[uv], sign * shift, chart_of_uv_[uv]));
    }
  for (size_t vertex = 0; vertex < displacement_m.size(); ++vertex) displacement_m[vertex] *= share[vertex];
}

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
#include "bake/align/lift.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace fourdvt::bake {
namespace {

constexpr double kFlowPyramidScale = 0.5;
constexpr int kFlowLevels = 5, kFlowWindow = 15, kFlowIterations = 2, kFlowPolyN = 5;
constexpr double kFlowPolySigma = 1.1;
constexpr float kDisagreement_px = 1.0f;    // forward-backward error at which certainty falls to 1/e …
constexpr float kDisagreementShare = 0.1f;  // … plus this share of the flow's length
constexpr float kTexture = 20;              // grey² a pixel²: gradient energy at which certainty is one quarter
constexpr double kTextureSigma_px = 4;
constexpr float kOutlier_px = 0.7f;  // Cauchy's scale
constexpr int kRobustRounds = 3;
constexpr float kPrior = 1e-3f;  // information of "no displacement", while views are weighed

cv::Mat flowBetween(const cv::Mat& from, const cv::Mat& to) {
  cv::Mat flow;
  cv::calcOpticalFlowFarneback(from, to, flow, kFlowPyramidScale, kFlowLevels, kFlowWindow, kFlowIterations, kFlowPolyN,
                               kFlowPolySigma, 0);
  return flow;
}

// CV_32FC3: gradient energies xx, yy, xy, averaged round each pixel, of both pictures.
cv::Mat structureTensor(const cv::Mat& first, const cv::Mat& other) {
  cv::Mat sum(first.size(), CV_32FC3, cv::Scalar(0)), dx, dy;
  for (const cv::Mat* picture : {&first, &other}) {
    cv::Scharr(*picture, dx, CV_32F, 1, 0, 1.0 / 32);
    cv::Scharr(*picture, dy, CV_32F, 0, 1, 1.0 / 32);
    const cv::Mat planes[] = {0.5 * dx.mul(dx), 0.5 * dy.mul(dy), 0.5 * dx.mul(dy)};
    cv::Mat tensor;
    cv::merge(planes, 3, tensor);
    sum += tensor;
  }
  cv::GaussianBlur(sum, sum, cv::Size(), kTextureSigma_px);
  return sum;
}

// Bilinear, clamped at the edges; pixel centres at +0.5.
template <class Pixel>
Pixel sample(const cv::Mat& picture, const glm::vec2& at) {
  const float x = std::clamp(at.x - 0.5f, 0.0f, float(picture.cols - 1));
  const float y = std::clamp(at.y - 0.5f, 0.0f, float(picture.rows - 1));
  const int x0 = std::min(int(x), std::max(picture.cols - 2, 0)), y0 = std::min(int(y), std::max(picture.rows - 2, 0));
  const int x1 = std::min(x0 + 1, picture.cols - 1), y1 = std::min(y0 + 1, picture.rows - 1);
  const float u = x - float(x0), v = y - float(y0);
  return (picture.at<Pixel>(y0, x0) * (1 - u) + picture.at<Pixel>(y0, x1) * u) * (1 - v) +
         (picture.at<Pixel>(y1, x0) * (1 - u) + picture.at<Pixel>(y1, x1) * u) * v;
}

glm::vec2 sampleFlow(const cv::Mat& flow, const glm::vec2& at) {
  const auto value = sample<cv::Vec2f>(flow, at);
  return {value[0], value[1]};
}

// (S (S + k)⁻¹)²: certain only along directions that have texture, so that noise in plain places does not count.
glm::mat2 textureCertainty(const cv::Vec3f& tensor) {
  const glm::mat2 energy(tensor[0], tensor[2], tensor[2], tensor[1]);
  const glm::mat2 share = energy * glm::inverse(energy + glm::mat2(kTexture));
  return share * share;
}

}  // namespace

std::vector<FlowObservation> observeFlow(const cv::Mat& first, const cv::Mat& other, const cv::Mat& interior,
                                         const std::vector<SeenVertex>& seen) {
  const cv::Mat forward = flowBetween(first, other), backward = flowBetween(other, first);
  const cv::Mat texture = structureTensor(first, other);
  std::vector<FlowObservation> observations;
  observations.reserve(seen.size());
  for (const SeenVertex& vertex : seen) {
    // Where the first picture shows the surface point that both pictures show half the flow away from the vertex.
    const glm::vec2 start = vertex.pixel - 0.5f * sampleFlow(forward, vertex.pixel);
    const glm::vec2 there = sampleFlow(forward, start);
    const glm::vec2 back = sampleFlow(backward, start + there);
    const float scale = kDisagreement_px + kDisagreementShare * glm::length(there);
    const float disagreement = glm::length(there + back) / scale;
    const float facing = vertex.cosine * vertex.cosine;
    const float certainty = facing * std::exp(-disagreement * disagreement) * sample<float>(interior, vertex.pixel);
    observations.push_back({vertex.vertex, vertex.pixels_per_metre, vertex.pixels_from_tangents,
                            certainty * textureCertainty(sample<cv::Vec3f>(texture, vertex.pixel)),
                            0.5f * (there - back)});
  }
  return observations;
}

std::vector<VertexEstimate> liftFlow(const std::vector<std::vector<FlowObservation>>& views,
                                     const std::vector<glm::vec2>& current) {
  std::vector<VertexEstimate> estimates;
  std::vector<glm::vec2> missing(current.size(), glm::vec2(0));
  for (int round = 0; round < kRobustRounds; ++round) {
    estimates.assign(current.size(), {});
    for (const auto& view : views)
      for (const FlowObservation& seen : view) {
        const glm::vec2 error = seen.flow - seen.pixels_from_tangents * missing[seen.vertex];
        const float outlier = glm::dot(error, seen.certainty * error) / (kOutlier_px * kOutlier_px);
        const glm::mat2 scaled = seen.pixels_from_tangents / seen.pixels_per_metre;
        const glm::mat2 weighted = glm::transpose(scaled) * seen.certainty * (round ? 1 / (1 + outlier) : 1.0f);
        estimates[seen.vertex].information += weighted * scaled;
        estimates[seen.vertex].pull += weighted * seen.flow / seen.pixels_per_metre;
      }
    for (size_t vertex = 0; vertex < missing.size(); ++vertex)
      missing[vertex] = glm::inverse(estimates[vertex].information + glm::mat2(kPrior)) * estimates[vertex].pull;
  }
  for (size_t vertex = 0; vertex < current.size(); ++vertex)
    estimates[vertex].pull += estimates[vertex].information * current[vertex];
  return estimates;
}

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
#include "bake/align/tangent_field.h"

#include <algorithm>
#include <cmath>
#include <numeric>
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
constexpr float kOutlier_px = 0.7f;  // scale of the Cauchy weight
constexpr int kRobustRounds = 3;
constexpr float kPrior = 1e-3f;  // information of a zero-displacement prior, while views are reweighted

cv::Mat flowBetween(const cv::Mat& from, const cv::Mat& to) {
  cv::Mat flow;
  cv::calcOpticalFlowFarneback(from, to, flow, kFlowPyramidScale, kFlowLevels, kFlowWindow, kFlowIterations, kFlowPolyN,
                               kFlowPolySigma, 0);
  return flow;
}

// CV_32FC3: gradient energies xx, yy, xy of both pictures, averaged round each pixel.
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

// (S (S + k)⁻¹)²: certain only along directions that have texture, so that noise in untextured places does not count.
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
    // Position in the first picture of the surface point that both pictures show half the flow away from the vertex.
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

namespace {

using Entries = std::vector<Eigen::Triplet<double>>;

constexpr double kLength_m = 0.01;               // smoothing length at smoothness 1 and information 1
constexpr double kPull = 1e-3;                   // information of a zero-displacement prior
constexpr double kMinArea = 1e-3;                // vertex area, in mean vertex areas
constexpr double kMinEdge = 0.05, kMaxEdge = 5;  // cotangent weights of badly shaped faces are clamped

double cotangent(const glm::vec3& a, const glm::vec3& b) {
  const double area = glm::length(glm::cross(a, b));
  return area > 0 ? glm::dot(a, b) / area : 0;
}

std::vector<double> vertexAreas(const MeshTopology& topology, std::span<const glm::vec3> base) {
  std::vector<double> areas(topology.vertex_count, 0);
  double sum = 0;
  for (const glm::uvec3& face : topology.face_vertices) {
    const double area = 0.5 * glm::length(glm::cross(base[face.y] - base[face.x], base[face.z] - base[face.x]));
    for (int corner = 0; corner < 3; ++corner) areas[face[corner]] += area / 3;
    sum += area;
  }
  const double mean = sum > 0 ? sum / topology.vertex_count : 1;
  for (double& area : areas) area = std::max(area, kMinArea * mean);
  return areas;
}

void addBlock(uint32_t row, uint32_t column, const glm::dmat2& block, Entries& entries) {
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) entries.emplace_back(2 * row + i, 2 * column + j, block[j][i]);
}

// Minimal rotation that takes components along `from` to components along `to`.
glm::dmat2 transport(const glm::mat2x3& from, const glm::mat2x3& to) {
  const glm::mat2 b = glm::transpose(to) * from;
  const glm::dvec2 turn(double(b[0][0]) + b[1][1], double(b[0][1]) - b[1][0]);
  const double length = glm::length(turn);
  const glm::dvec2 unit = length > 0 ? turn / length : glm::dvec2(1, 0);
  return {unit.x, unit.y, -unit.y, unit.x};
}

}  // namespace

TangentSmoother::TangentSmoother(const MeshTopology& topology, std::span<const glm::vec3> base,
                                 const SurfaceFrames& frames, double smoothness)
    : areas_(vertexAreas(topology, base)) {
  Entries entries;
  const double scale = smoothness * smoothness * kLength_m * kLength_m;
  for (const glm::uvec3& face : topology.face_vertices)
    for (int corner = 0; corner < 3; ++corner) {
      const uint32_t apex = face[corner], a = face[(corner + 1) % 3], b = face[(corner + 2) % 3];
      if (a == b) continue;
      const double weight =
          0.5 * scale * std::clamp(cotangent(base[a] - base[apex], base[b] - base[apex]), kMinEdge, kMaxEdge);
      const glm::dmat2 b_from_a = transport(frames.tangents[a], frames.tangents[b]);
      addBlock(a, a, glm::dmat2(weight), entries);
      addBlock(b, b, glm::dmat2(weight), entries);
      addBlock(b, a, -weight * b_from_a, entries);
      addBlock(a, b, -weight * glm::transpose(b_from_a), entries);
    }
  for (uint32_t vertex = 0; vertex < topology.vertex_count;
       ++vertex)  // all four entries, so that the sparsity pattern is constant
    addBlock(vertex, vertex, glm::dmat2(kPull * areas_[vertex], 0, 0, kPull * areas_[vertex]), entries);
  smooth_.resize(2 * topology.vertex_count, 2 * topology.vertex_count);
  smooth_.setFromTriplets(entries.begin(), entries.end());
  solver_.analyzePattern(smooth_);
}

std::vector<glm::vec2> TangentSmoother::solve(const std::vector<VertexEstimate>& estimates) {
  Matrix matrix = smooth_;
  Eigen::VectorXd right(matrix.rows());
  for (size_t vertex = 0; vertex < estimates.size(); ++vertex)
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j)
        matrix.coeffRef(2 * vertex + i, 2 * vertex + j) += areas_[vertex] * estimates[vertex].information[j][i];
      right[2 * vertex + i] = areas_[vertex] * estimates[vertex].pull[i];
    }
  solver_.factorize(matrix);
  const Eigen::VectorXd field = solver_.solve(right);
  std::vector<glm::vec2> displacement(estimates.size());
  for (size_t vertex = 0; vertex < estimates.size(); ++vertex)
    displacement[vertex] = {field[2 * vertex], field[2 * vertex + 1]};
  return displacement;
}

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
  const int steps = int(std::ceil(glm::length(shift) * float(size_)));  // at most one texel each
  for (int step = 1; step <= steps; ++step) {
    const glm::vec2 texel = glm::floor((uv + shift * (float(step) / float(steps))) * float(size_));
    const glm::ivec2 at(glm::clamp(texel, glm::vec2(0), glm::vec2(float(size_ - 1))));
    // The thin end of a chart may cover no texel centre: texels outside all charts count as the chart's own within
    // one texel.
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

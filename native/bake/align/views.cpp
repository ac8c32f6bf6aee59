// SPDX-License-Identifier: Apache-2.0
#include "bake/align/views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace fourdvt::bake {
namespace {

constexpr double kRaised_deg = 35;
constexpr double kDistance = 2.5;  // from the centre, in diagonals of the bounds
constexpr int kMargin = 12;        // pixels round the figure
constexpr float kDepthTolerance_m = 0.01f;
constexpr float kDepthStep_m = 0.03f;  // between neighbouring pixels, on top of the slope at kMinCosine
constexpr float kMinCosine = 0.15f;    // below it a surface is too foreshortened to show tangential motion

// Fits focal length, principal point and width to the points.
PinholeCamera fitted(PinholeCamera camera, const Positions& positions, int height) {
  camera.fx = camera.fy = 1;
  camera.cx = camera.cy = 0;
  glm::dvec2 low(std::numeric_limits<double>::max()), high(-low);
  for (const glm::vec3& position : positions) {
    const glm::dvec2 at(camera.project(position));
    low = glm::min(low, at);
    high = glm::max(high, at);
  }
  const int margin = std::min(kMargin, height / 8);
  camera.fx = camera.fy = (height - 2 * margin) / (high.y - low.y);
  camera.height = height;
  camera.width = int(std::ceil(camera.fx * (high.x - low.x))) + 2 * margin;
  camera.cx = 0.5 * camera.width - 0.5 * camera.fx * (low.x + high.x);
  camera.cy = 0.5 * camera.height - 0.5 * camera.fy * (low.y + high.y);
  return camera;
}

float cross2(const glm::vec2& a, const glm::vec2& b) { return a.x * b.y - a.y * b.x; }

// Keeps the nearest depth of a triangle's pixels; points are pixel x, pixel y, depth.
void drawTriangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, cv::Mat& depth) {
  const glm::vec2 a2(a), b2(b), c2(c);
  const float area = cross2(b2 - a2, c2 - a2);
  if (!(std::abs(area) > 1e-6f)) return;
  const float sign = area < 0 ? -1.0f : 1.0f;
  const glm::vec2 low = glm::min(a2, glm::min(b2, c2)), high = glm::max(a2, glm::max(b2, c2));
  const int x0 = std::max(0, int(std::floor(low.x))), x1 = std::min(depth.cols - 1, int(std::ceil(high.x)));
  const int y0 = std::max(0, int(std::floor(low.y))), y1 = std::min(depth.rows - 1, int(std::ceil(high.y)));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const glm::vec2 p(x + 0.5f, y + 0.5f);
      const float of_a = cross2(b2 - p, c2 - p), of_b = cross2(c2 - p, a2 - p);
      if (of_a * sign < 0 || of_b * sign < 0) continue;  // avoids divisions for pixels outside the triangle
      const float u = of_a / area, v = of_b / area, w = 1 - u - v;
      if (w < 0) continue;
      float& nearest = depth.at<float>(y, x);
      nearest = std::min(nearest, 1 / (u / a.z + v / b.z + w / c.z));
    }
}

// Pixels per metre of a point's movement, 3 columns.
glm::mat3x2 projectionDerivative(const PinholeCamera& camera, const glm::vec3& point) {
  const glm::dvec3 p(camera.cam_from_world * glm::dvec4(point, 1));
  const glm::dmat3x2 from_cam(glm::dvec2(camera.fx / p.z, 0), glm::dvec2(0, camera.fy / p.z),
                              glm::dvec2(-camera.fx * p.x, -camera.fy * p.y) / (p.z * p.z));
  return glm::mat3x2(from_cam * glm::dmat3(camera.cam_from_world));
}

}  // namespace

std::vector<PinholeCamera> alignmentCameras(const Positions& positions, int count, int height) {
  glm::dvec3 low(positions[0]), high(positions[0]);
  for (const glm::vec3& position : positions) {
    low = glm::min(low, glm::dvec3(position));
    high = glm::max(high, glm::dvec3(position));
  }
  OrbitView orbit;
  orbit.target_in_world = 0.5 * (low + high);
  orbit.distance_m = kDistance * glm::length(high - low);
  std::vector<PinholeCamera> cameras;
  for (int i = 0; i < count; ++i) {
    orbit.azimuth_deg = 360.0 * i / count;
    orbit.elevation_deg = i % 2 ? kRaised_deg : 0;
    cameras.push_back(fitted(cameraFromOrbit(orbit, height, height), positions, height));
  }
  return cameras;
}

std::vector<glm::mat2x3> poseTangents(const MeshTopology& topology, std::span<const glm::vec3> base,
                                      const SurfaceFrames& frames, std::span<const glm::vec3> pose) {
  std::vector<glm::mat2x3> moved(topology.vertex_count, glm::mat2x3(0));
  std::vector<glm::mat2> planar(topology.vertex_count, glm::mat2(0));
  for (const glm::uvec3& face : topology.face_vertices)
    for (int corner = 0; corner < 3; ++corner)
      for (int other = 1; other < 3; ++other) {
        const uint32_t from = face[corner], to = face[(corner + other) % 3];
        const glm::vec2 along = (base[to] - base[from]) * frames.tangents[from];
        moved[from] += glm::outerProduct(pose[to] - pose[from], along);
        planar[from] += glm::outerProduct(along, along);
      }
  std::vector<glm::vec3> normals;
  computeVertexNormals(topology.face_vertices, pose.data(), pose.size(), normals);
  for (uint32_t vertex = 0; vertex < topology.vertex_count; ++vertex) {
    const float scale = planar[vertex][0][0] + planar[vertex][1][1];
    if (!(glm::determinant(planar[vertex]) > 1e-6f * scale * scale)) {
      moved[vertex] = glm::mat2x3(0);
      continue;
    }
    const glm::mat2x3 tangents = moved[vertex] * glm::inverse(planar[vertex]);
    moved[vertex] = tangents - glm::outerProduct(normals[vertex], normals[vertex] * tangents);
  }
  return moved;
}

cv::Mat drawDepth(const PinholeCamera& camera, const MeshTopology& topology, const Positions& positions) {
  cv::Mat depth(camera.height, camera.width, CV_32F, cv::Scalar(std::numeric_limits<float>::infinity()));
  std::vector<glm::vec3> projected;
  projected.reserve(positions.size());
  for (const glm::vec3& position : positions) projected.emplace_back(camera.project(position));
  for (const glm::uvec3& face : topology.face_vertices)
    drawTriangle(projected[face.x], projected[face.y], projected[face.z], depth);
  return depth;
}

cv::Mat interiorOf(const cv::Mat& depth, float reach) {
  cv::Mat inside(depth.size(), CV_8U, cv::Scalar(255));
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) {
      const float here = depth.at<float>(y, x);
      bool step = !std::isfinite(here);
      if (x + 1 < depth.cols) step |= !(std::abs(depth.at<float>(y, x + 1) - here) < kDepthStep_m);
      if (y + 1 < depth.rows) step |= !(std::abs(depth.at<float>(y + 1, x) - here) < kDepthStep_m);
      if (step) inside.at<uint8_t>(y, x) = 0;
    }
  cv::Mat distance;
  cv::distanceTransform(inside, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  cv::Mat share = distance / reach;
  cv::min(share, 1.0, share);
  return share;
}

std::vector<SeenVertex> seenVertices(const PinholeCamera& camera, const cv::Mat& depth, const Positions& positions,
                                     const std::vector<glm::vec3>& normals, const std::vector<glm::mat2x3>& tangents) {
  const glm::vec3 eye(camera.centreInWorld());
  std::vector<SeenVertex> seen;
  for (uint32_t vertex = 0; vertex < positions.size(); ++vertex) {
    const float cosine = glm::dot(normals[vertex], glm::normalize(eye - positions[vertex]));
    if (!(cosine > kMinCosine)) continue;
    const glm::vec3 at(camera.project(positions[vertex]));
    const int x = int(std::floor(at.x)), y = int(std::floor(at.y));
    if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) continue;
    if (!(at.z < depth.at<float>(y, x) + kDepthTolerance_m)) continue;
    seen.push_back({vertex, glm::vec2(at), cosine, float(camera.fx) / at.z,
                    projectionDerivative(camera, positions[vertex]) * tangents[vertex]});
  }
  return seen;
}

namespace {

constexpr float kNeighbourhood = 0.03f;  // side of the window of local contrast, in picture heights
constexpr float kMinContrast = 8;        // grey: deviation at which texture starts to count
constexpr float kContrast = 40;          // grey: deviation of textured places in the result

}  // namespace

cv::Mat evenLuma(const cv::Mat& rgba) {
  const int side = int(kNeighbourhood * float(rgba.rows)) | 1;
  const cv::Size window(side, side);
  cv::Mat luma, alpha, inside, share, mean, variance, even;
  cv::cvtColor(rgba, luma, cv::COLOR_RGBA2GRAY);
  cv::extractChannel(rgba, alpha, 3);
  luma.convertTo(luma, CV_32F);
  alpha.convertTo(inside, CV_32F, 1.0 / 255);
  cv::blur(inside, share, window);
  share += 1e-6;
  cv::blur(luma.mul(inside), mean, window);
  const cv::Mat deviation = (luma - mean / share).mul(inside);
  cv::blur(deviation.mul(deviation), variance, window);
  cv::sqrt(variance / share, variance);
  cv::Mat(deviation / (variance + kMinContrast) * kContrast + 128).convertTo(even, CV_8U);
  return even;
}

namespace {

constexpr int kEdge = 4;  // pixels along the outline that are left out

cv::Mat lumaOf(const cv::Mat& rgba) {
  cv::Mat luma;
  cv::cvtColor(rgba, luma, cv::COLOR_RGBA2GRAY);
  luma.convertTo(luma, CV_32F);
  return luma;
}

cv::Mat insideOf(const cv::Mat& rgba) {
  cv::Mat alpha, inside;
  cv::extractChannel(rgba, alpha, 3);
  cv::erode(alpha == 255, inside, cv::getStructuringElement(cv::MORPH_RECT, {2 * kEdge + 1, 2 * kEdge + 1}), {-1, -1},
            1, cv::BORDER_CONSTANT, cv::Scalar(0));
  return inside;
}

double gradientEnergy(const cv::Mat& luma, const cv::Mat& inside) {
  const cv::Matx13f across(-0.5f, 0, 0.5f);
  cv::Mat x, y, energy;
  cv::filter2D(luma, x, CV_32F, across);
  cv::filter2D(luma, y, CV_32F, across.t());
  energy = x.mul(x) + y.mul(y);
  return cv::mean(energy, inside)[0] * cv::countNonZero(inside);
}

}  // namespace

DetailEnergy detailEnergy(const std::vector<cv::Mat>& looks) {
  const cv::Mat inside = insideOf(looks[0]);
  cv::Mat sum = cv::Mat::zeros(inside.size(), CV_32F);
  DetailEnergy energy;
  for (const cv::Mat& look : looks) {
    const cv::Mat luma = lumaOf(look);
    energy.own.push_back(gradientEnergy(luma, inside));
    sum += luma;
  }
  energy.sum = gradientEnergy(sum, inside);
  return energy;
}

float detailCorrelation(const std::vector<DetailEnergy>& views) {
  double own = 0, sum = 0;
  size_t looks = 2;
  for (const DetailEnergy& view : views) {
    for (const double energy : view.own) own += energy;
    sum += view.sum;
    looks = view.own.size();
  }
  if (own == 0) return 1;
  return static_cast<float>(std::clamp((sum - own) / (own * double(looks - 1)), 0.0, 1.0));
}

}  // namespace fourdvt::bake

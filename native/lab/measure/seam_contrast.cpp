// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/seam_contrast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "base/face_buffer.h"
#include "measure/metrics.h"

namespace fourdvt::measure {
namespace {

constexpr double kReach = 1.5, kControl = 6;  // pixels across the seam
constexpr double kDepthStep = 0.03;           // between probes on the same surface
constexpr int kBand = 3, kInsideFrom = 5, kInsideTo = 9;
constexpr double kFringe = 0.25;

struct EdgeUvs {
  uint32_t face;
  glm::vec2 a, b;  // at the lower and the higher vertex
};

glm::dvec3 faceNormal(const glm::uvec3& f, const Positions& positions) {
  const glm::dvec3 a(positions[f.x]);
  const glm::dvec3 n = glm::cross(glm::dvec3(positions[f.y]) - a, glm::dvec3(positions[f.z]) - a);
  return n / std::max(glm::length(n), 1e-14);
}

class SeamProbe {
 public:
  SeamProbe(const Image& picture, const PinholeCamera& view, const MeshTopology& topology, const Positions& positions)
      : width_(picture.width), height_(picture.height), buffer_(rasterise(view, topology.face_vertices, positions, 1)) {
    luma_.resize(static_cast<size_t>(width_) * height_);
    for (size_t i = 0; i < luma_.size(); ++i) {
      const uint8_t* p = &picture.pixels[i * picture.channels];
      luma_[i] = 0.299f * p[0] + 0.587f * p[1] + 0.114f * p[2];
    }
  }

  // Seam and control contrast across `at`; nullopt unless one surface covers all of it.
  std::optional<std::pair<double, double>> across(const glm::dvec2& at, const glm::dvec2& normal,
                                                  double depth_m) const {
    constexpr std::array<double, 9> kOffsets{-kControl - kReach, -kControl, -kControl + kReach, -kReach, 0, kReach,
                                             kControl - kReach,  kControl,  kControl + kReach};
    double luma[9], last_depth = 0;
    for (size_t k = 0; k < kOffsets.size(); ++k) {
      const glm::dvec2 p = at + kOffsets[k] * normal;
      const int x = int(std::floor(p.x)), y = int(std::floor(p.y));
      if (x < 1 || y < 1 || x >= width_ - 1 || y >= height_ - 1) return {};
      const double depth = buffer_.depth_m[static_cast<size_t>(y) * width_ + x];
      if (!std::isfinite(depth) || (k > 0 && std::abs(depth - last_depth) > kDepthStep)) return {};
      if (k == 4 && std::abs(depth - depth_m) > kDepthStep) return {};
      last_depth = depth;
      luma[k] = bilinear(p);
    }
    const auto contrast = [&](int k) {
      return std::abs(luma[k + 1] - luma[k - 1]) + std::abs(luma[k] - 0.5 * (luma[k + 1] + luma[k - 1]));
    };
    return std::pair(contrast(4), 0.5 * (contrast(1) + contrast(7)));
  }

 private:
  double bilinear(const glm::dvec2& p) const {
    const double fx = p.x - 0.5, fy = p.y - 0.5;
    const int x = int(std::floor(fx)), y = int(std::floor(fy));
    const float* row = &luma_[static_cast<size_t>(y) * width_ + x];
    const double tx = fx - x, ty = fy - y;
    return (1 - ty) * ((1 - tx) * row[0] + tx * row[1]) + ty * ((1 - tx) * row[width_] + tx * row[width_ + 1]);
  }

  int width_, height_;
  FaceBuffer buffer_;
  std::vector<float> luma_;
};

// Chessboard distance to the nearest pixel outside the mask; 0 outside. Beyond the picture counts as inside.
std::vector<int> depthInside(std::vector<uint8_t>& mask, int w, int h) {
  cv::Mat out;
  cv::distanceTransform(cv::Mat(h, w, CV_8U, mask.data()), out, cv::DIST_C, cv::DIST_MASK_3);
  return {out.begin<float>(), out.end<float>()};
}

// Excess of one channel over the other two.
template <class Colour>
double excess(const Colour& c, int channel) {
  return double(c[channel]) - std::max(double(c[(channel + 1) % 3]), double(c[(channel + 2) % 3]));
}

}  // namespace

std::vector<ChartSeam> chartSeams(const MeshTopology& topology) {
  std::map<std::pair<uint32_t, uint32_t>, std::vector<EdgeUvs>> by_vertices;
  for (uint32_t f = 0; f < topology.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      EdgeUvs edge{f, topology.uvs[topology.face_uvs[f][k]], topology.uvs[topology.face_uvs[f][next]]};
      if (topology.face_vertices[f][k] > topology.face_vertices[f][next]) std::swap(edge.a, edge.b);
      by_vertices[std::minmax(topology.face_vertices[f][k], topology.face_vertices[f][next])].push_back(edge);
    }
  }
  std::vector<ChartSeam> seams;
  for (const auto& [vertices, edges] : by_vertices)
    if (edges.size() == 2 && (edges[0].a != edges[1].a || edges[0].b != edges[1].b))
      seams.push_back({vertices.first, vertices.second, edges[0].face, edges[1].face});
  return seams;
}

SeamContrast seamContrast(const Image& picture, const PinholeCamera& view, const MeshTopology& topology,
                          const Positions& positions, const SeamOptions& options) {
  const SeamProbe probe(picture, view, topology, positions);
  const glm::dvec3 eye = view.centreInWorld();
  const double max_cosine = std::cos(glm::radians(options.min_angle_deg));
  SeamContrast sum;
  for (const ChartSeam& seam : chartSeams(topology)) {
    const glm::dvec3 a(positions[seam.vertex_a]), b(positions[seam.vertex_b]);
    const glm::dvec3 to_eye = glm::normalize(eye - 0.5 * (a + b));
    const double cosine_a = glm::dot(faceNormal(topology.face_vertices[seam.face_a], positions), to_eye);
    const double cosine_b = glm::dot(faceNormal(topology.face_vertices[seam.face_b], positions), to_eye);
    if (std::min(cosine_a, cosine_b) <= 0 || std::max(cosine_a, cosine_b) > max_cosine) continue;
    const glm::dvec3 from = view.project(a), to = view.project(b);
    const double length = glm::length(glm::dvec2(to - from));
    if (from.z <= 0 || to.z <= 0 || length < 0.5) continue;
    const glm::dvec2 along = glm::dvec2(to - from) / length, normal(-along.y, along.x);
    const int count = std::max(1, int(length));
    for (int k = 0; k < count; ++k) {
      const glm::dvec3 p = glm::mix(from, to, (k + 0.5) / count);
      const auto contrast = probe.across(glm::dvec2(p), normal, p.z);
      if (!contrast) continue;
      sum.seam += contrast->first;
      sum.control += contrast->second;
      ++sum.samples;
    }
  }
  if (sum.samples) sum.seam /= double(sum.samples), sum.control /= double(sum.samples);
  return sum;
}

double fringeShare(const Image& rgba, const glm::dvec3& backdrop) {
  const int w = rgba.width, h = rgba.height;
  std::vector<uint8_t> mask(static_cast<size_t>(w) * h);
  for (size_t i = 0; i < mask.size(); ++i) mask[i] = rgba.pixels[4 * i + 3] >= 128;
  const std::vector<int> depth = depthInside(mask, w, h);
  int channel = 0;
  for (int c = 1; c < 3; ++c)
    if (backdrop[c] > backdrop[channel]) channel = c;
  const double backdrop_excess = excess(backdrop, channel);
  size_t band = 0, tinted = 0;
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const int d = depth[static_cast<size_t>(y) * w + x];
      if (d < 1 || d > kBand) continue;
      double inside = -256;
      for (int v = std::max(0, y - kInsideTo); v <= std::min(h - 1, y + kInsideTo); ++v) {
        for (int u = std::max(0, x - kInsideTo); u <= std::min(w - 1, x + kInsideTo); ++u) {
          const int its = depth[static_cast<size_t>(v) * w + u];
          if (its >= kInsideFrom && its <= kInsideTo) inside = std::max(inside, excess(rgba.at(u, v), channel));
        }
      }
      if (inside < -255) continue;  // too thin to classify
      ++band;
      tinted += excess(rgba.at(x, y), channel) > inside + kFringe * (backdrop_excess - inside);
    }
  }
  return band ? double(tinted) / double(band) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace fourdvt::measure

// SPDX-License-Identifier: Apache-2.0
#include "refine/outline.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace fourdvt::refine {
namespace {

constexpr float kNearest = 0.05f;  // metres in front of the camera
// Beyond the outline nothing of the mesh may lie within these pixels: fillConvexPoly draws up to a pixel too much.
constexpr float kClearFrom = 2, kClearTo = 8;
// A clear edge: this far inside the matte's edge alpha is at least kInside, this far outside at most kOutside.
constexpr float kPlateau = 2, kInside = 192, kOutside = 64;

// What the mesh covers in one camera's picture.
class Coverage {
 public:
  Coverage(const PinholeCamera& camera, std::span<const glm::uvec3> face_vertices, std::span<const glm::vec2> pixels,
           const std::vector<bool>& in_front) {
    glm::vec2 low(1e9f), high(-1e9f);
    for (size_t v = 0; v < pixels.size(); ++v)
      if (in_front[v]) low = glm::min(low, pixels[v]), high = glm::max(high, pixels[v]);
    left_ = std::max(0, int(low.x) - 1);
    top_ = std::max(0, int(low.y) - 1);
    const int right = std::min(camera.width, int(high.x) + 2), bottom = std::min(camera.height, int(high.y) + 2);
    mask_ = cv::Mat::zeros(std::max(1, bottom - top_), std::max(1, right - left_), CV_8UC1);
    for (const glm::uvec3& face : face_vertices) {
      cv::Point corners[3];
      bool drawn = true;
      for (int k = 0; k < 3; ++k) {
        const uint32_t v = face[k];
        drawn = drawn && in_front[v];
        corners[k] = {int(std::lround((pixels[v].x - 0.5f - left_) * 16)),
                      int(std::lround((pixels[v].y - 0.5f - top_) * 16))};
      }
      if (drawn) cv::fillConvexPoly(mask_, corners, 3, cv::Scalar(255), cv::LINE_8, 4);
    }
  }
  bool covers(const glm::vec2& pixel) const {
    const int x = int(std::floor(pixel.x)) - left_, y = int(std::floor(pixel.y)) - top_;
    return x >= 0 && y >= 0 && x < mask_.cols && y < mask_.rows && mask_.at<uint8_t>(y, x);
  }
  bool clearBeyond(const glm::vec2& pixel, const glm::vec2& outward) const {
    for (float t = kClearFrom; t <= kClearTo; t += 1)
      if (covers(pixel + t * outward)) return false;
    return true;
  }

 private:
  int left_ = 0, top_ = 0;
  cv::Mat mask_;
};

// The crossing from figure to background along `outward` that is nearest to `pixel`.
// Nothing is known beyond the picture's border: an edge must lie well inside.
std::optional<float> findEdge(const MatteCrop& matte, const glm::vec2& size, const glm::vec2& pixel,
                              const glm::vec2& outward, float reach) {
  constexpr float kStep = 0.5f;
  constexpr float kHalf = 127.5f;
  const auto alpha = [&](float t) {
    const glm::vec2 p = pixel + t * outward;
    return matte.at(p.x, p.y);
  };
  // Interval after interval on both sides, so that the first crossings found are the nearest.
  std::optional<float> best;
  const auto look = [&](float inner, float at_inner, float at_outer) {
    if (at_inner < kHalf || at_outer >= kHalf) return;
    const float edge = inner + kStep * (at_inner - kHalf) / (at_inner - at_outer);
    if (!best || std::abs(edge) < std::abs(*best)) best = edge;
  };
  float outer = alpha(0), inner = outer;
  for (float t = 0; t < reach && !best; t += kStep) {
    const float further = alpha(t + kStep), deeper = alpha(-t - kStep);
    look(t, outer, further);
    look(-t - kStep, deeper, inner);
    outer = further;
    inner = deeper;
  }
  const auto inside = [&](float t) {
    const glm::vec2 p = pixel + t * outward;
    return p.x >= 1 && p.y >= 1 && p.x <= size.x - 1 && p.y <= size.y - 1;
  };
  if (best && !(inside(*best - kPlateau) && inside(*best + kPlateau))) return std::nullopt;
  if (best && (alpha(*best - kPlateau) < kInside || alpha(*best + kPlateau) > kOutside)) return std::nullopt;
  return best;
}

}  // namespace

std::vector<InnerEdge> innerEdges(std::span<const glm::uvec3> face_vertices) {
  std::map<std::pair<uint32_t, uint32_t>, std::vector<std::pair<uint32_t, bool>>> faces;  // with: runs low → high
  for (uint32_t f = 0; f < face_vertices.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = face_vertices[f][k], b = face_vertices[f][(k + 1) % 3];
      faces[std::minmax(a, b)].push_back({f, a < b});
    }
  std::vector<InnerEdge> out;
  for (const auto& [ends, beside] : faces)
    if (beside.size() == 2 && beside[0].second != beside[1].second)
      out.push_back(
          {ends.first, ends.second, beside[beside[0].second ? 0 : 1].first, beside[beside[0].second ? 1 : 0].first});
  return out;
}

float MatteCrop::at(float x, float y) const {
  const float fx = x - 0.5f - float(left), fy = y - 0.5f - float(top);
  const int x0 = int(std::floor(fx)), y0 = int(std::floor(fy));
  const float u = fx - float(x0), v = fy - float(y0);
  const auto pixel = [&](int i, int j) -> float {
    return i >= 0 && j >= 0 && i < alpha.width && j < alpha.height ? float(*alpha.at(i, j)) : 0.0f;
  };
  return (1 - v) * ((1 - u) * pixel(x0, y0) + u * pixel(x0 + 1, y0)) +
         v * ((1 - u) * pixel(x0, y0 + 1) + u * pixel(x0 + 1, y0 + 1));
}

std::vector<OutlinePoint> outlinePoints(const PinholeCamera& camera, std::span<const glm::uvec3> face_vertices,
                                        std::span<const InnerEdge> edges, std::span<const glm::vec3> positions,
                                        std::span<const glm::vec3> normals, const MatteCrop& matte,
                                        const OutlineOptions& options) {
  const glm::mat4 cam_from_world(camera.cam_from_world);
  const glm::mat3 rotation(cam_from_world);
  const glm::vec2 focal(camera.fx, camera.fy), centre(camera.cx, camera.cy);
  std::vector<glm::vec3> in_cam(positions.size());
  std::vector<glm::vec2> pixels(positions.size());
  std::vector<bool> in_front(positions.size());
  for (size_t v = 0; v < positions.size(); ++v) {
    in_cam[v] = glm::vec3(cam_from_world * glm::vec4(positions[v], 1));
    in_front[v] = in_cam[v].z > kNearest;
    if (in_front[v]) pixels[v] = focal * glm::vec2(in_cam[v]) / in_cam[v].z + centre;
  }
  std::vector<bool> faces_camera(face_vertices.size());
  for (size_t f = 0; f < face_vertices.size(); ++f) {
    const glm::uvec3& v = face_vertices[f];
    const glm::vec3 normal = glm::cross(in_cam[v.y] - in_cam[v.x], in_cam[v.z] - in_cam[v.x]);
    faces_camera[f] = glm::dot(normal, in_cam[v.x]) < 0;
  }
  const Coverage coverage(camera, face_vertices, pixels, in_front);
  std::vector<OutlinePoint> out;
  for (const InnerEdge& edge : edges) {
    if (faces_camera[edge.left_face] == faces_camera[edge.right_face]) continue;
    if (!in_front[edge.from] || !in_front[edge.to]) continue;
    const glm::vec2 along = pixels[edge.to] - pixels[edge.from];
    const float length = glm::length(along);
    if (length < 1e-3f) continue;
    const int count = std::max(1, int(std::lround(length / options.spacing_pixels)));
    for (int i = 0; i < count; ++i) {
      OutlinePoint s;
      s.from = edge.from;
      s.to = edge.to;
      s.to_share = (float(i) + 0.5f) / float(count);
      s.point_in_cam = glm::mix(in_cam[edge.from], in_cam[edge.to], s.to_share);
      const glm::vec3 normal = rotation * glm::mix(normals[edge.from], normals[edge.to], s.to_share);
      const glm::vec3& p = s.point_in_cam;
      const glm::vec2 moves = focal * (glm::vec2(normal) - glm::vec2(p) * (normal.z / p.z)) / p.z;
      // Outward is across the edge, on the side that the normal points to.
      const glm::vec2 across = glm::vec2(along.y, -along.x) / length;
      s.outward = glm::dot(across, moves) < 0 ? -across : across;
      s.pixels_per_metre = glm::dot(s.outward, moves);
      const glm::vec2 pixel = glm::mix(pixels[edge.from], pixels[edge.to], s.to_share);
      // Where the vertex normals do not lie across the edge, an offset along them does not move the outline.
      if (s.pixels_per_metre < 0.5f * focal.x / p.z || !coverage.clearBeyond(pixel, s.outward)) continue;
      const glm::vec2 edge_at = pixel + options.matte_bias_pixels * s.outward;
      const auto found =
          findEdge(matte, glm::vec2(camera.width, camera.height), edge_at, s.outward, options.reach_pixels);
      if (!found) continue;
      s.residual_pixels = *found;
      out.push_back(s);
    }
  }
  return out;
}

}  // namespace fourdvt::refine

// SPDX-License-Identifier: Apache-2.0
#include "refine/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "base/image.h"

namespace fourdvt::refine {
namespace {

constexpr float kNearest = 0.05f;  // metres in front of the camera
// Range beyond the outline, pixels, in which no part of the mesh may lie; fillConvexPoly draws up to a pixel too much.
constexpr float kClearFrom = 2, kClearTo = 8;
// Clear edge: alpha is at least kInside kPlateau pixels inside the matte's edge, at most kOutside as far outside.
constexpr float kPlateau = 2, kInside = 192, kOutside = 64;

// Coverage of one camera's picture by the mesh.
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

// Nearest crossing from figure to background to `pixel` along `outward`. Edges must lie well inside the picture.
std::optional<float> findEdge(const MatteCrop& matte, const glm::vec2& size, const glm::vec2& pixel,
                              const glm::vec2& outward, float reach) {
  constexpr float kStep = 0.5f;
  constexpr float kHalf = 127.5f;
  const auto alpha = [&](float t) {
    const glm::vec2 p = pixel + t * outward;
    return matte.at(p.x, p.y);
  };
  // Alternates intervals on both sides, so that the first crossings found are the nearest.
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
  std::map<std::pair<uint32_t, uint32_t>, std::vector<std::pair<uint32_t, bool>>> faces;  // runs low → high
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
      // Perpendicular to the edge, on the side of the normal.
      const glm::vec2 across = glm::vec2(along.y, -along.x) / length;
      s.outward = glm::dot(across, moves) < 0 ? -across : across;
      s.pixels_per_metre = glm::dot(s.outward, moves);
      const glm::vec2 pixel = glm::mix(pixels[edge.from], pixels[edge.to], s.to_share);
      // Skips samples where an offset along the vertex normal hardly moves the outline.
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

namespace {

constexpr int kScale = 2, kMargin = 12;  // pixels of the picture
constexpr float kAgree = 0.25f, kFull = 2, kDark = 0.6f;

cv::Scalar colourOf(float residual) {
  if (std::abs(residual) <= kAgree) return {40, 220, 60};
  const double share = std::min(1.0f, (std::abs(residual) - kAgree) / (kFull - kAgree));
  const double pale = 200 * (1 - share);
  return residual < 0 ? cv::Scalar(255, pale, 40) : cv::Scalar(40, pale, 255);
}

}  // namespace

Image outlinePicture(const Image& rgba, const PinholeCamera& camera, std::span<const OutlinePoint> points) {
  int left = rgba.width, top = rgba.height, right = 0, bottom = 0;
  for (int y = 0; y < rgba.height; ++y)
    for (int x = 0; x < rgba.width; ++x) {
      if (rgba.at(x, y)[3] < 128) continue;
      left = std::min(left, x - kMargin);
      right = std::max(right, x + kMargin);
      top = std::min(top, y - kMargin);
      bottom = y + kMargin;
    }
  left = std::max(0, left);
  top = std::max(0, top);
  right = std::min(rgba.width, right);
  bottom = std::min(rgba.height, bottom);
  if (right <= left || bottom <= top) return Image(2, 2, 3);
  const cv::Mat whole(rgba.height, rgba.width, CV_8UC4, const_cast<uint8_t*>(rgba.pixels.data()));
  cv::Mat part;
  cv::cvtColor(whole(cv::Rect(left, top, right - left, bottom - top)), part, cv::COLOR_RGBA2RGB);
  cv::resize(part, part, {}, kScale, kScale, cv::INTER_LINEAR);
  part *= kDark;
  for (const OutlinePoint& s : points) {
    const glm::vec3& p = s.point_in_cam;
    const double x = camera.fx * p.x / p.z + camera.cx - left, y = camera.fy * p.y / p.z + camera.cy - top;
    cv::circle(part, cv::Point(int(std::lround(x * kScale)), int(std::lround(y * kScale))), 1,
               colourOf(s.residual_pixels), cv::FILLED, cv::LINE_8);
  }
  Image out(part.cols, part.rows, 3);
  part.copyTo(cv::Mat(part.rows, part.cols, CV_8UC3, out.pixels.data()));
  return out;
}

Image beside(const Image& left, const Image& right) {
  Image out(left.width + right.width, left.height, 3);
  for (int y = 0; y < left.height; ++y) {
    std::copy_n(left.at(0, y), size_t(left.width) * 3, out.at(0, y));
    std::copy_n(right.at(0, y), size_t(right.width) * 3, out.at(left.width, y));
  }
  return out;
}

namespace {

constexpr float kInner = 4, kOuter = 7;  // pixels from the matte's edge
constexpr float kContrast = 0.06f;       // minimum distance between the two colours, linear light
constexpr float kReach = 4;              // pixels; edges further away belong to something else

struct LinearLight {
  std::array<float, 256> of;
  LinearLight() {
    for (int i = 0; i < 256; ++i) of[size_t(i)] = linearFromSrgb(float(i) / 255);
  }
};

class Profile {
 public:
  Profile(const Image& rgba, glm::vec2 origin, glm::vec2 outward) : rgba_(rgba), origin_(origin), outward_(outward) {}
  // Linear colour and matte (0…1).
  glm::vec4 at(float t) const {
    static const LinearLight linear;
    const glm::vec2 p = origin_ + t * outward_ - 0.5f;
    const int x = int(std::floor(p.x)), y = int(std::floor(p.y));
    const float u = p.x - float(x), v = p.y - float(y);
    glm::vec4 sum(0);
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        const uint8_t* q = rgba_.at(x + i, y + j);
        sum += (i ? u : 1 - u) * (j ? v : 1 - v) *
               glm::vec4(linear.of[q[0]], linear.of[q[1]], linear.of[q[2]], float(q[3]) / 255);
      }
    return sum;
  }
  glm::vec3 mean(float from, float to) const {
    glm::vec3 sum(0);
    constexpr int kTaps = 4;
    for (int i = 0; i < kTaps; ++i) sum += glm::vec3(at(from + (to - from) * float(i) / (kTaps - 1)));
    return sum / float(kTaps);
  }

 private:
  const Image& rgba_;
  const glm::vec2 origin_, outward_;
};

// Nearest position to 0 at which `value` falls through one half towards the outside.
template <class Value>
std::optional<float> crossing(const Value& value, float reach) {
  constexpr float kStep = 0.25f;
  std::optional<float> best;
  float before = value(-reach);
  for (float t = -reach; t < reach; t += kStep) {
    const float after = value(t + kStep);
    if (before >= 0.5f && after < 0.5f) {
      const float at = t + kStep * (before - 0.5f) / (before - after);
      if (!best || std::abs(at) < std::abs(*best)) best = at;
    }
    before = after;
  }
  return best;
}

std::optional<double> offsetAt(const Image& rgba, int x, int y) {
  const auto alpha = [&](int i, int j) { return float(rgba.at(i, j)[3]); };
  const glm::vec2 gradient(alpha(x + 1, y) - alpha(x - 1, y), alpha(x, y + 1) - alpha(x, y - 1));
  const float length = glm::length(gradient);
  if (length < 64) return std::nullopt;
  const Profile profile(rgba, glm::vec2(x + 0.5f, y + 0.5f), -gradient / length);
  const auto matte_edge = crossing([&](float t) { return profile.at(t).a; }, 1.5f);
  if (!matte_edge) return std::nullopt;
  const float m = *matte_edge;
  if (profile.at(m - kInner).a < 0.95f || profile.at(m - kOuter).a < 0.95f) return std::nullopt;
  if (profile.at(m + kInner).a > 0.05f || profile.at(m + kOuter).a > 0.05f) return std::nullopt;
  const glm::vec3 figure = profile.mean(m - kOuter, m - kInner), background = profile.mean(m + kInner, m + kOuter);
  const glm::vec3 between = figure - background;
  const float squared = glm::dot(between, between);
  if (squared < kContrast * kContrast) return std::nullopt;
  const auto picture_edge =
      crossing([&](float t) { return glm::dot(glm::vec3(profile.at(m + t)) - background, between) / squared; }, kReach);
  if (!picture_edge) return std::nullopt;
  return -double(*picture_edge);
}

}  // namespace

std::vector<double> matteEdgeOffsets(const Image& rgba, int stride) {
  const int margin = int(kOuter + kReach) + 3;
  std::vector<double> out;
  int seen = 0;
  for (int y = margin; y < rgba.height - margin; ++y)
    for (int x = margin; x < rgba.width - margin; ++x) {
      const uint8_t here = rgba.at(x, y)[3];
      // Pixel beside the edge: at least half inside, with a neighbour that is not.
      if (here < 128) continue;
      if (rgba.at(x + 1, y)[3] >= 128 && rgba.at(x - 1, y)[3] >= 128 && rgba.at(x, y + 1)[3] >= 128 &&
          rgba.at(x, y - 1)[3] >= 128)
        continue;
      if (seen++ % stride) continue;
      if (const auto offset = offsetAt(rgba, x, y)) out.push_back(*offset);
    }
  return out;
}

}  // namespace fourdvt::refine

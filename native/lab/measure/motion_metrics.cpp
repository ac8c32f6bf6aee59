// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/motion_metrics.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/face_buffer.h"

namespace fourdvt::measure {
namespace {

constexpr float kNaNf = std::numeric_limits<float>::quiet_NaN();
constexpr uint32_t kNoFace = 0xffffffffu;

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// Perspective-correct barycentric weights of a face's corners at a pixel's centre.
glm::dvec3 sharesUnder(const glm::dvec3 projected[3], const glm::dvec2& pixel) {
  const glm::dvec2 a(projected[0]), b(projected[1]), c(projected[2]);
  glm::dvec3 shares(cross(c - b, pixel - b), cross(a - c, pixel - c), cross(b - a, pixel - a));
  for (int k = 0; k < 3; ++k) shares[k] /= projected[k].z;
  return shares / (shares.x + shares.y + shares.z);
}

}  // namespace

Mask eroded(const Mask& inside, int width, int height, int pixels) {
  Mask out(inside.size());
  const cv::Mat from(height, width, CV_8U, const_cast<uint8_t*>(inside.data()));
  cv::Mat to(height, width, CV_8U, out.data());
  const cv::Mat square = cv::Mat::ones(2 * pixels + 1, 2 * pixels + 1, CV_8U);
  cv::erode(from, to, square, {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  return out;
}

Sharpness sharpness(const Image& rgb, const Mask& inside) {
  const std::vector<double> y = luma(rgb);
  const int width = rgb.width;
  Sharpness sum;
  size_t count = 0;
  for (int row = 1; row + 1 < rgb.height; ++row)
    for (int column = 1; column + 1 < width; ++column) {
      const size_t at = static_cast<size_t>(row) * width + column;
      if (!inside[at]) continue;
      const double dx = (y[at + 1] - y[at - 1]) / 2, dy = (y[at + width] - y[at - width]) / 2;
      const double laplacian = y[at + 1] + y[at - 1] + y[at + width] + y[at - width] - 4 * y[at];
      sum.gradient += dx * dx + dy * dy;
      sum.detail += laplacian * laplacian;
      ++count;
    }
  return count ? Sharpness{sum.gradient / count, sum.detail / count} : Sharpness{kNaN, kNaN};
}

glm::vec2 flowAt(const FlowField& flow, glm::dvec2 pixel) {
  const double x = pixel.x - 0.5, y = pixel.y - 0.5;
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  if (!(x >= 0 && y >= 0) || left + 1 >= flow.width || top + 1 >= flow.height) return glm::vec2(kNaNf);
  const float u = static_cast<float>(x - left), v = static_cast<float>(y - top);
  const glm::vec2* at = flow.displacement.data() + static_cast<size_t>(top) * flow.width + left;
  return (1 - v) * ((1 - u) * at[0] + u * at[1]) + v * ((1 - u) * at[flow.width] + u * at[flow.width + 1]);
}

FlowField surfaceFlow(const PinholeCamera& camera, const std::vector<glm::uvec3>& faces, const Positions& positions,
                      const std::vector<glm::vec3>& moved, std::vector<float>* metres_per_pixel) {
  const FaceBuffer seen = rasterise(camera, faces, positions, 1);
  FlowField out{camera.width, camera.height, std::vector<glm::vec2>(seen.face.size(), glm::vec2(kNaNf))};
  if (metres_per_pixel) metres_per_pixel->assign(seen.face.size(), kNaNf);
  for (size_t i = 0; i < seen.face.size(); ++i) {
    const uint32_t face = seen.face[i];
    if (face == kNoFace) continue;
    glm::dvec3 projected[3], target(0);
    for (int k = 0; k < 3; ++k) projected[k] = camera.project(glm::dvec3(positions[faces[face][k]]));
    const auto width = static_cast<size_t>(camera.width);
    const glm::dvec2 pixel(double(i % width) + 0.5, double(i / width) + 0.5);
    const glm::dvec3 shares = sharesUnder(projected, pixel);
    for (int k = 0; k < 3; ++k) target += shares[k] * glm::dvec3(moved[3 * size_t(face) + size_t(k)]);
    out.displacement[i] = glm::vec2(glm::dvec2(camera.project(target)) - pixel);
    if (metres_per_pixel) (*metres_per_pixel)[i] = seen.depth_m[i] / static_cast<float>(camera.fx);
  }
  return out;
}

void ErrorSamples::add(float value) {
  if (!std::isnan(value)) values_.push_back(value);
}

double ErrorSamples::mean() const {
  return values_.empty() ? kNaN : std::accumulate(values_.begin(), values_.end(), 0.0) / double(values_.size());
}

double ErrorSamples::tail() const {
  if (values_.empty()) return kNaN;
  std::vector<float> sorted = values_;
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>((sorted.size() - 1) * 95 / 100);
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at;
}

void addDifferences(const FlowField& a, const FlowField& b, const Mask& inside, ErrorSamples& out) {
  for (size_t i = 0; i < inside.size(); ++i)
    if (inside[i]) out.add(glm::length(a.displacement[i] - b.displacement[i]));
}

double pictureChange(const Image& a, const Image& b) {
  const Mask either = unionOfSilhouettes(a, b);
  const Image x = compositedOnBlack(a), y = compositedOnBlack(b);
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < either.size(); ++i) {
    if (!either[i]) continue;
    for (size_t c = 0; c < 3; ++c) sum += std::abs(int(x.pixels[3 * i + c]) - int(y.pixels[3 * i + c]));
    count += 3;
  }
  return count ? sum / double(count) : 0;
}

double largestStep_m(const Positions& a, const Positions& b) {
  double largest = 0;
  for (size_t v = 0; v < a.size() && v < b.size(); ++v)
    largest = std::max(largest, static_cast<double>(glm::distance(a[v], b[v])));
  return largest;
}

double commonFrame(std::span<const double> first, std::span<const double> second, bool loop, double w, double phase) {
  const size_t count = first.size();
  const double turns = loop ? std::round(second[0] - first[0]) : 0;
  const auto passed = [&](size_t f) {
    return (1 - w) * first[f % count] + w * (second[f % count] - turns) + double(f / count);
  };
  if (loop) phase += std::ceil(passed(0) - phase);
  const size_t last = loop ? count : count - 1;
  for (size_t f = 0; f < last; ++f)
    if (phase < passed(f + 1)) return double(f) + (phase - passed(f)) / (passed(f + 1) - passed(f));
  return double(last);
}

}  // namespace fourdvt::measure

// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/appearance_score.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/face_buffer.h"
#include "measure/metrics.h"

namespace fourdvt::measure {
namespace {

constexpr int kOutline_px = 2;      // border excluded for mismatched outlines
constexpr double kHidden_m = 0.02;  // behind the nearest surface

double decibels(double squares, size_t count) {
  if (count == 0) return kNaN;
  return squares == 0 ? kEqual_db : 10 * std::log10(255.0 * 255.0 * double(count) / squares);
}

uint64_t squaresAt(const Image& truth, int x, int y, const Image& picture, int px, int py) {
  const uint8_t *a = truth.at(x, y), *b = picture.at(px, py);
  uint64_t sum = 0;
  for (int c = 0; c < 3; ++c) sum += uint64_t((int(a[c]) - b[c]) * (int(a[c]) - b[c]));
  return sum;
}

// Minimum sum of squares over the shifts, over the pixels of a block inside the region; and their number.
std::pair<uint64_t, size_t> bestShift(const Image& truth, const Image& picture, const Mask& inside,
                                      const ShiftTolerance& tolerance, int left, int top) {
  std::vector<std::pair<int, int>> pixels;
  for (int y = top; y < std::min(top + tolerance.block_px, truth.height); ++y)
    for (int x = left; x < std::min(left + tolerance.block_px, truth.width); ++x)
      if (inside[size_t(y) * truth.width + x]) pixels.emplace_back(x, y);
  uint64_t best = std::numeric_limits<uint64_t>::max();
  for (int dy = -tolerance.reach_px; dy <= tolerance.reach_px; ++dy)
    for (int dx = -tolerance.reach_px; dx <= tolerance.reach_px; ++dx) {
      uint64_t squares = 0;
      for (const auto& [x, y] : pixels)
        squares += squaresAt(truth, x, y, picture, std::clamp(x + dx, 0, truth.width - 1),
                             std::clamp(y + dy, 0, truth.height - 1));
      best = std::min(best, squares);
    }
  return {best, 3 * pixels.size()};
}

// Error over black, and the intersection of both silhouettes.
struct ErrorPicture {
  int width = 0, height = 0;
  std::vector<std::array<float, 3>> error;
  Mask shown;
};

ErrorPicture errorOf(const TrueAndDrawn& pair) {
  const Image truth = compositedOnBlack(pair.truth), picture = compositedOnBlack(pair.picture);
  ErrorPicture out{truth.width, truth.height, {}, commonSilhouette(pair.truth, pair.picture)};
  out.error.resize(out.shown.size());
  for (size_t i = 0; i < out.error.size(); ++i)
    for (size_t c = 0; c < 3; ++c) out.error[i][c] = float(picture.pixels[3 * i + c]) - float(truth.pixels[3 * i + c]);
  return out;
}

// Samples bilinearly; false if a contributing pixel is outside the silhouettes.
bool sample(const ErrorPicture& e, double x, double y, std::array<float, 3>& out) {
  out = {};
  const int left = int(std::floor(x - 0.5)), top = int(std::floor(y - 0.5));
  const float u = float(x - 0.5 - left), v = float(y - 0.5 - top);
  for (int k = 0; k < 4; ++k) {
    const float share = (k & 1 ? u : 1 - u) * (k & 2 ? v : 1 - v);
    if (share == 0) continue;
    const int px = left + (k & 1), py = top + (k >> 1);
    if (px < 0 || py < 0 || px >= e.width || py >= e.height) return false;
    const size_t at = size_t(py) * e.width + px;
    if (!e.shown[at]) return false;
    for (size_t c = 0; c < 3; ++c) out[c] += share * e.error[at][c];
  }
  return true;
}

}  // namespace

double rmse(const Image& a, const Image& b, const Mask& inside) { return std::pow(10, -psnr(a, b, inside) / 20); }

double gradientRatio(const Image& truth, const Image& picture, const Mask& inside) {
  const double wanted = sharpness(truth, inside).gradient;
  return wanted > 0 ? sharpness(picture, inside).gradient / wanted : kNaN;
}

double shiftTolerantPsnr(const Image& truth, const Image& picture, const Mask& inside,
                         const ShiftTolerance& tolerance) {
  uint64_t squares = 0;
  size_t count = 0;
  for (int top = 0; top < truth.height; top += tolerance.block_px)
    for (int left = 0; left < truth.width; left += tolerance.block_px) {
      const auto [best, values] = bestShift(truth, picture, inside, tolerance, left, top);
      if (values == 0) continue;
      squares += best;
      count += values;
    }
  return decibels(double(squares), count);
}

FlowField visibleMotion(const PinholeCamera& camera, const std::vector<glm::uvec3>& faces, const Positions& before,
                        const Positions& now) {
  std::vector<glm::vec3> corners;
  corners.reserve(3 * faces.size());
  for (const glm::uvec3& face : faces)
    for (int k = 0; k < 3; ++k) corners.push_back(now[face[k]]);
  FlowField out = surfaceFlow(camera, faces, before, corners);
  const FaceBuffer first = rasterise(camera, faces, before, 1), next = rasterise(camera, faces, now, 1);
  for (size_t i = 0; i < out.displacement.size(); ++i) {
    glm::vec2& moved = out.displacement[i];
    if (std::isnan(moved.x)) continue;
    const int x = int(std::floor(double(i % size_t(out.width)) + 0.5 + moved.x)),
              y = int(std::floor(double(i / size_t(out.width)) + 0.5 + moved.y));
    float nearest = std::numeric_limits<float>::infinity(), depth = 0;
    if (x >= 0 && y >= 0 && x < out.width && y < out.height) nearest = next.depth_m[size_t(y) * out.width + x];
    const glm::uvec3& face = faces[first.face[i]];
    for (int k = 0; k < 3; ++k) depth += float(camera.project(glm::dvec3(now[face[k]])).z) / 3;
    if (!std::isfinite(nearest) || depth > nearest + kHidden_m) moved = glm::vec2(kNaN);
  }
  return out;
}

double flickerLevels(const TrueAndDrawn& before, const TrueAndDrawn& now, const FlowField& motion) {
  const ErrorPicture a = errorOf(before), b = errorOf(now);
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < a.shown.size(); ++i) {
    const glm::vec2 moved = motion.displacement[i];
    std::array<float, 3> there;
    if (!a.shown[i] || std::isnan(moved.x)) continue;
    const double x = double(i % size_t(a.width)) + 0.5 + moved.x, y = double(i / size_t(a.width)) + 0.5 + moved.y;
    if (!sample(b, x, y, there)) continue;
    for (size_t c = 0; c < 3; ++c) sum += std::abs(there[c] - a.error[i][c]);
    count += 3;
  }
  return count ? sum / double(count) : kNaN;
}

AppearanceScore scoreAppearance(const Image& truth, const Image& picture) {
  AppearanceScore out{scorePicture(truth, picture), 0, 0, 0};
  const Mask either = unionOfSilhouettes(truth, picture);
  const Mask inner = eroded(commonSilhouette(truth, picture), truth.width, truth.height, kOutline_px);
  const Image a = compositedOnBlack(truth), b = compositedOnBlack(picture);
  out.rmse = rmse(a, b, either);
  out.gradient_ratio = gradientRatio(a, b, inner);
  out.shift_tolerant_db = shiftTolerantPsnr(a, b, either);
  return out;
}

AppearanceScore meanAppearance(const std::vector<AppearanceScore>& scores) {
  AppearanceScore mean;
  MeanScores pictures;
  for (const AppearanceScore& score : scores) pictures.add(score.picture);
  mean.picture = pictures.mean();
  for (const auto field :
       {&AppearanceScore::rmse, &AppearanceScore::gradient_ratio, &AppearanceScore::shift_tolerant_db}) {
    size_t count = 0;
    for (const AppearanceScore& score : scores)
      if (!std::isnan(score.*field)) mean.*field += score.*field, ++count;
    mean.*field = count ? mean.*field / double(count) : kNaN;
  }
  return mean;
}

}  // namespace fourdvt::measure

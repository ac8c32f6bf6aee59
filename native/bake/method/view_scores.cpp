// SPDX-License-Identifier: Apache-2.0
#include "bake/method/view_scores.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::bake {
namespace {

using measure::Mask;

// Pixels of the mask, row by row.
std::vector<glm::ivec2> pixelsOf(const Mask& inside, int width) {
  std::vector<glm::ivec2> out;
  for (size_t i = 0; i < inside.size(); ++i)
    if (inside[i]) out.emplace_back(int(i % size_t(width)), int(i / size_t(width)));
  return out;
}

// Bilinear; pixels beyond the border repeat it.
void sample(const Image& image, const glm::ivec2& pixel, const glm::dvec2& shift_px, float out[3]) {
  const glm::ivec2 whole(glm::floor(shift_px));
  const glm::vec2 share(shift_px - glm::dvec2(whole));
  const auto at = [&](int x, int y) {
    return image.at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1));
  };
  const int x = pixel.x + whole.x, y = pixel.y + whole.y;
  const uint8_t *a = at(x, y), *b = at(x + 1, y), *c = at(x, y + 1), *d = at(x + 1, y + 1);
  for (int k = 0; k < 3; ++k)
    out[k] = (1 - share.y) * ((1 - share.x) * float(a[k]) + share.x * float(b[k])) +
             share.y * ((1 - share.x) * float(c[k]) + share.x * float(d[k]));
}

// Mean square of the differences of every `step`-th pixel.
double differences(const Image& truth, const Image& picture, const std::vector<glm::ivec2>& pixels,
                   const glm::dvec2& shift_px, size_t step) {
  double sum = 0;
  for (size_t i = 0; i < pixels.size(); i += step) {
    float moved[3];
    sample(picture, pixels[i], shift_px, moved);
    const uint8_t* wanted = truth.at(pixels[i].x, pixels[i].y);
    for (int k = 0; k < 3; ++k) sum += double((moved[k] - wanted[k]) * (moved[k] - wanted[k]));
  }
  return sum;
}

glm::dvec2 bestShift(const Image& truth, const Image& picture, const std::vector<glm::ivec2>& pixels) {
  glm::dvec2 best(0);
  const auto search = [&](double reach, double step_px, size_t step) {
    const glm::dvec2 centre = best;
    double least = differences(truth, picture, pixels, centre, step);
    for (double dy = -reach; dy <= reach; dy += step_px)
      for (double dx = -reach; dx <= reach; dx += step_px) {
        const glm::dvec2 at = centre + glm::dvec2(dx, dy);
        if (std::max(std::abs(at.x), std::abs(at.y)) > kMaxShift_px) continue;
        const double value = differences(truth, picture, pixels, at, step);
        if (value < least) least = value, best = at;
      }
  };
  const size_t few = std::max<size_t>(1, pixels.size() / 4000), many = std::max<size_t>(1, pixels.size() / 20'000);
  search(kMaxShift_px, 1, few);
  search(0.5, 0.5, many);
  search(0.25, 0.25, many);
  return best;
}

}  // namespace

RegisteredScore registeredScore(const Image& truth, const Image& picture, const Mask& inside) {
  RegisteredScore out;
  out.shift_px = bestShift(truth, picture, pixelsOf(inside, truth.width));
  Image moved(picture.width, picture.height, 3);
  for (int y = 0; y < moved.height; ++y)
    for (int x = 0; x < moved.width; ++x) {
      float value[3];
      sample(picture, {x, y}, out.shift_px, value);
      for (int k = 0; k < 3; ++k) moved.at(x, y)[k] = uint8_t(std::lround(value[k]));
    }
  const double psnr_db = measure::psnr(truth, moved, inside);
  out.psnr_db = std::isinf(psnr_db) ? measure::kEqual_db : psnr_db;
  out.ssim = measure::ssim(truth, moved, inside);
  return out;
}

namespace {

constexpr int kMaxPixels = 512;         // longer side of a buffer
constexpr double kTolerance_m = 0.015;  // tolerance of the depth test, for a person's surface
constexpr double kMinCosine = 0.1;      // see render::MethodOptions

PinholeCamera coarser(const PinholeCamera& camera) {
  const int longest = std::max(camera.width, camera.height);
  if (longest <= kMaxPixels) return camera;
  const auto side = [&](int pixels) { return std::max(1, int(int64_t(pixels) * kMaxPixels / longest)); };
  return scaledCamera(camera, side(camera.width), side(camera.height));
}

struct SurfacePoint {
  glm::dvec3 point{0}, normal{0};
};

// Perspective-correct interpolation.
SurfacePoint pointAt(const ProjectedFace& t, const glm::uvec3& face, const TriangleMesh& surface,
                     const std::vector<glm::vec3>& normals, const glm::dvec2& sample) {
  double w[3], sum = 0;
  t.barycentric(sample, w);
  for (int k = 0; k < 3; ++k) sum += w[k] *= t.inverse_depth[k];
  SurfacePoint out;
  for (int k = 0; k < 3; ++k) {
    out.point += (w[k] / sum) * glm::dvec3(surface.positions[face[k]]);
    out.normal += (w[k] / sum) * glm::dvec3(normals[face[k]]);
  }
  out.normal /= std::max(glm::length(out.normal), 1e-12);
  return out;
}

}  // namespace

SharedSight::SharedSight(const std::vector<PinholeCamera>& cameras, const TriangleMesh& surface, double length_scale)
    : surface_(surface), tolerance_m_(length_scale * kTolerance_m) {
  computeVertexNormals(surface.faces, surface.positions.data(), surface.positions.size(), normals_);
  for (const PinholeCamera& camera : cameras) {
    const PinholeCamera coarse = coarser(camera);
    seen_.push_back({coarse, coarse.centreInWorld(), rasterise(coarse, surface.faces, surface.positions, 1)});
  }
}

double SharedSight::secondShare(const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& to_eye,
                                std::optional<size_t> left_out) const {
  double sum = 0, first = 0, second = 0;
  for (size_t c = 0; c < seen_.size(); ++c) {
    if (c == left_out) continue;
    const Seen& s = seen_[c];
    const glm::dvec3 to_camera = glm::normalize(s.centre_in_world - point);
    const double cosine = glm::dot(normal, to_camera), weight = cosine * glm::dot(to_camera, to_eye);
    if (cosine <= kMinCosine || weight <= 0) continue;
    const glm::dvec3 at = s.camera.project(point);
    if (at.z <= 0 || at.x < 0 || at.y < 0 || at.x >= s.camera.width || at.y >= s.camera.height) continue;
    const float nearest_m = s.buffer.depth_m[size_t(at.y) * size_t(s.buffer.width) + size_t(at.x)];
    if (at.z > nearest_m + tolerance_m_) continue;
    sum += weight;
    second = std::max(second, std::min(first, weight));
    first = std::max(first, weight);
  }
  return sum > 0 ? second / sum : 0;
}

measure::Mask SharedSight::of(const PinholeCamera& view, std::optional<size_t> left_out) const {
  const PinholeCamera coarse = coarser(view);
  const FaceBuffer shown = rasterise(coarse, surface_.faces, surface_.positions, 1);
  const glm::dvec3 eye = view.centreInWorld();
  measure::Mask few(size_t(coarse.width) * size_t(coarse.height), 0);
  for (size_t i = 0; i < few.size(); ++i) {
    ProjectedFace t;
    if (shown.face[i] == FaceBuffer::kNoFace) continue;
    const glm::uvec3& face = surface_.faces[shown.face[i]];
    if (!projectFace(coarse, face, surface_.positions, 1, t)) continue;
    const glm::dvec2 sample(double(i % size_t(coarse.width)) + 0.5, double(i / size_t(coarse.width)) + 0.5);
    const SurfacePoint s = pointAt(t, face, surface_, normals_, sample);
    few[i] = secondShare(s.point, s.normal, glm::normalize(eye - s.point), left_out) >= kSharedWeight;
  }
  if (coarse.width == view.width && coarse.height == view.height) return few;
  measure::Mask out(size_t(view.width) * size_t(view.height));
  for (size_t y = 0; y < size_t(view.height); ++y)
    for (size_t x = 0; x < size_t(view.width); ++x)
      out[y * size_t(view.width) + x] = few[y * size_t(coarse.height) / size_t(view.height) * size_t(coarse.width) +
                                            x * size_t(coarse.width) / size_t(view.width)];
  return out;
}

}  // namespace fourdvt::bake

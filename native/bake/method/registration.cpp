// SPDX-License-Identifier: Apache-2.0
#include "bake/method/registration.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::bake {
namespace {

using measure::Mask;

// Where the mask is set, in the order of rows.
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
        if (std::max(std::abs(at.x), std::abs(at.y)) > kMostShift_px) continue;
        const double value = differences(truth, picture, pixels, at, step);
        if (value < least) least = value, best = at;
      }
  };
  const size_t few = std::max<size_t>(1, pixels.size() / 4000), many = std::max<size_t>(1, pixels.size() / 20'000);
  search(kMostShift_px, 1, few);
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

}  // namespace fourdvt::bake

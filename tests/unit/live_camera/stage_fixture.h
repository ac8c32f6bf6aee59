// SPDX-License-Identifier: Apache-2.0
// Pictures of a stage with a disc in front, whose coverage is computed exactly.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <random>

#include "base/image.h"

namespace fourdvt::live::testing {

using Colour = std::array<double, 3>;

// A wall with soft stripes, above a floor.
inline Image wallPlate(int width, int height) {
  Image out(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double wave = 20 * std::sin(0.15 * x) + 12 * std::sin(0.2 * y), floor = y > 0.7 * height ? -25 : 0;
      const Colour colour{150 + wave + floor, 135 + wave + floor, 115 + wave + floor};
      for (int c = 0; c < 3; ++c) out.at(x, y)[c] = uint8_t(std::lround(colour[size_t(c)]));
    }
  return out;
}

inline Image greenPlate(int width, int height) {
  Image out(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double light = 1 - 0.3 * std::hypot(x / double(width) - 0.5, y / double(height) - 0.5);
      const Colour colour{60 * light, 160 * light, 75 * light};
      for (int c = 0; c < 3; ++c) out.at(x, y)[c] = uint8_t(std::lround(colour[size_t(c)]));
    }
  return out;
}

// Share of a pixel inside the disc, 0…1.
inline double discShare(int x, int y, const glm::dvec2& centre, double radius_px) {
  constexpr int kFine = 8;
  int inside = 0;
  for (int j = 0; j < kFine; ++j)
    for (int i = 0; i < kFine; ++i)
      inside += glm::length(glm::dvec2(x + (i + 0.5) / kFine, y + (j + 0.5) / kFine) - centre) < radius_px;
  return double(inside) / (kFine * kFine);
}

inline void paint(Image& picture, const std::function<double(int, int)>& share, const Colour& colour) {
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const double s = share(x, y);
      for (int c = 0; c < 3; ++c) {
        uint8_t& value = picture.at(x, y)[c];
        value = uint8_t(std::lround(s * colour[size_t(c)] + (1 - s) * value));
      }
    }
}

inline void paintDisc(Image& picture, const glm::dvec2& centre, double radius_px, const Colour& colour) {
  paint(
      picture, [&](int x, int y) { return discShare(x, y, centre, radius_px); }, colour);
}

// Multiplies by factor(x, y), as a shadow does.
inline void shade(Image& picture, const std::function<double(int, int)>& factor) {
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (int c = 0; c < 3; ++c) picture.at(x, y)[c] = uint8_t(std::lround(picture.at(x, y)[c] * factor(x, y)));
}

inline void addNoise(Image& picture, double deviation, uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, deviation);
  for (uint8_t& value : picture.pixels) value = uint8_t(std::clamp(std::lround(value + noise(random)), 0l, 255l));
}

inline double discIou(const Image& coverage, const glm::dvec2& centre, double radius_px) {
  double both = 0, either = 0;
  for (int y = 0; y < coverage.height; ++y)
    for (int x = 0; x < coverage.width; ++x) {
      const bool a = *coverage.at(x, y) >= 128, b = discShare(x, y, centre, radius_px) >= 0.5;
      both += a && b;
      either += a || b;
    }
  return both / either;
}

}  // namespace fourdvt::live::testing

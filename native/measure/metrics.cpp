// SPDX-License-Identifier: Apache-2.0
#include "measure/metrics.h"

#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace fourdvt::measure {
namespace {

constexpr int kRadius = kSsimWindow / 2;
using Plane = std::vector<double>;

std::array<double, kSsimWindow> gaussianTaps() {
  std::array<double, kSsimWindow> taps{};
  double sum = 0;
  for (int i = 0; i < kSsimWindow; ++i) sum += taps[i] = std::exp(-(i - kRadius) * (i - kRadius) / (2 * 1.5 * 1.5));
  for (double& t : taps) t /= sum;
  return taps;
}

// Separable window mean; valid at distances >= kRadius from the border.
Plane windowMean(const Plane& in, int width, int height) {
  static const auto taps = gaussianTaps();
  Plane rows(in.size(), 0), out(in.size(), 0);
  for (int y = 0; y < height; ++y) {
    const double* from = in.data() + static_cast<size_t>(y) * width;
    double* to = rows.data() + static_cast<size_t>(y) * width;
    for (int x = kRadius; x < width - kRadius; ++x) {
      double sum = 0;
      for (int k = 0; k < kSsimWindow; ++k) sum += taps[k] * from[x + k - kRadius];
      to[x] = sum;
    }
  }
  for (int y = kRadius; y < height - kRadius; ++y) {
    double* to = out.data() + static_cast<size_t>(y) * width;
    for (int k = 0; k < kSsimWindow; ++k) {
      const double* from = rows.data() + static_cast<size_t>(y + k - kRadius) * width;
      for (int x = 0; x < width; ++x) to[x] += taps[k] * from[x];
    }
  }
  return out;
}

Plane product(const Plane& a, const Plane& b) {
  Plane out(a.size());
  for (size_t i = 0; i < a.size(); ++i) out[i] = a[i] * b[i];
  return out;
}

}  // namespace

Image compositedOnBlack(const Image& rgba) {
  assert(rgba.channels == 4);
  Image out(rgba.width, rgba.height, 3);
  const size_t count = static_cast<size_t>(rgba.width) * rgba.height;
  for (size_t i = 0; i < count; ++i) {
    const uint8_t* p = rgba.pixels.data() + 4 * i;
    for (int c = 0; c < 3; ++c) out.pixels[3 * i + c] = static_cast<uint8_t>((p[c] * p[3] + 127) / 255);
  }
  return out;
}

Mask unionOfSilhouettes(const Image& a, const Image& b) {
  assert(a.channels == 4 && b.channels == 4 && a.pixels.size() == b.pixels.size());
  Mask mask(static_cast<size_t>(a.width) * a.height);
  for (size_t i = 0; i < mask.size(); ++i) mask[i] = a.pixels[4 * i + 3] >= 128 || b.pixels[4 * i + 3] >= 128;
  return mask;
}

Mask commonSilhouette(const Image& a, const Image& b) {
  assert(a.channels == 4 && b.channels == 4 && a.pixels.size() == b.pixels.size());
  Mask mask(static_cast<size_t>(a.width) * a.height);
  for (size_t i = 0; i < mask.size(); ++i) mask[i] = a.pixels[4 * i + 3] >= 128 && b.pixels[4 * i + 3] >= 128;
  return mask;
}

double psnr(const Image& a, const Image& b, const Mask& inside) {
  assert(a.channels == 3 && b.channels == 3 && a.pixels.size() == b.pixels.size() &&
         inside.size() * 3 == a.pixels.size());
  uint64_t squares = 0, count = 0;
  for (size_t i = 0; i < inside.size(); ++i) {
    if (!inside[i]) continue;
    for (int c = 0; c < 3; ++c) {
      const int d = int(a.pixels[3 * i + c]) - int(b.pixels[3 * i + c]);
      squares += static_cast<uint64_t>(d * d);
    }
    count += 3;
  }
  if (count == 0) return kNaN;
  if (squares == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(count) / static_cast<double>(squares));
}

std::vector<double> luma(const Image& rgb) {
  assert(rgb.channels == 3);
  Plane out(static_cast<size_t>(rgb.width) * rgb.height);
  for (size_t i = 0; i < out.size(); ++i) {
    const uint8_t* p = rgb.pixels.data() + 3 * i;
    out[i] = 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
  }
  return out;
}

std::vector<double> ssimMap(const Image& a, const Image& b) {
  assert(a.width == b.width && a.height == b.height);
  constexpr double kC1 = (0.01 * 255) * (0.01 * 255), kC2 = (0.03 * 255) * (0.03 * 255);
  const int w = a.width, h = a.height;
  const Plane la = luma(a), lb = luma(b);
  const Plane mean_a = windowMean(la, w, h), mean_b = windowMean(lb, w, h);
  const Plane square_a = windowMean(product(la, la), w, h), square_b = windowMean(product(lb, lb), w, h);
  const Plane cross = windowMean(product(la, lb), w, h);
  Plane map(la.size(), kNaN);
  for (int y = kRadius; y < h - kRadius; ++y) {
    for (int x = kRadius; x < w - kRadius; ++x) {
      const size_t i = static_cast<size_t>(y) * w + x;
      const double ma = mean_a[i], mb = mean_b[i];
      const double variances = square_a[i] - ma * ma + square_b[i] - mb * mb;
      const double covariance = cross[i] - ma * mb;
      map[i] = (2 * ma * mb + kC1) * (2 * covariance + kC2) / ((ma * ma + mb * mb + kC1) * (variances + kC2));
    }
  }
  return map;
}

double ssim(const Image& a, const Image& b, const Mask& inside) {
  const Plane map = ssimMap(a, b);
  assert(inside.size() == map.size());
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < map.size(); ++i) {
    if (!inside[i] || std::isnan(map[i])) continue;
    sum += map[i];
    ++count;
  }
  return count ? sum / static_cast<double>(count) : kNaN;
}

}  // namespace fourdvt::measure

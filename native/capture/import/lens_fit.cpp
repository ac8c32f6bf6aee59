// SPDX-License-Identifier: Apache-2.0
// Linear least squares on 1 + a1 s + a2 s² + a3 s³ = F(s) (1 + b1 s + b2 s² + b3 s³), s = r².
#include <array>
#include <cmath>
#include <utility>

#include "capture/import/camera_numbers.h"

namespace fourdvt::capture {
namespace {

constexpr int kUnknowns = 6, kSamples = 100;
constexpr double kRidge = 1e-13;  // keeps the equations regular where a lower degree suffices

using Equations = std::array<std::array<double, kUnknowns + 1>, kUnknowns>;

// Gaussian elimination with partial pivoting.
std::array<double, kUnknowns> solved(Equations e) {
  for (int i = 0; i < kUnknowns; ++i) {
    int pivot = i;
    for (int j = i + 1; j < kUnknowns; ++j)
      if (std::abs(e[j][i]) > std::abs(e[pivot][i])) pivot = j;
    std::swap(e[i], e[pivot]);
    for (int j = 0; j < kUnknowns; ++j) {
      if (j == i) continue;
      const double factor = e[j][i] / e[i][i];
      for (int k = i; k <= kUnknowns; ++k) e[j][k] -= factor * e[i][k];
    }
  }
  std::array<double, kUnknowns> out{};
  for (int i = 0; i < kUnknowns; ++i) out[i] = e[i][kUnknowns] / e[i][i];
  return out;
}

double radial(const Brown4& l, double s) { return 1 + s * (l.k1 + s * (l.k2 + s * (l.k3 + s * l.k4))); }

double rational(const Distortion& d, double s) {
  return (1 + s * (d.k1 + s * (d.k2 + s * d.k3))) / (1 + s * (d.k4 + s * (d.k5 + s * d.k6)));
}

}  // namespace

LensFit fitBrown4(const Brown4& lens, double radius) {
  Distortion d{lens.k1, lens.k2, lens.p1, lens.p2, lens.k3};
  if (lens.k4 == 0) return {d, 0};
  const double widest = radius * radius;  // maximum of s; the unknowns are those of s / widest
  Equations equations{};
  for (int i = 1; i <= kSamples; ++i) {
    const double t = static_cast<double>(i) / kSamples, f = radial(lens, t * widest);
    const std::array<double, kUnknowns + 1> row{t, t * t, t * t * t, -f * t, -f * t * t, -f * t * t * t, f - 1};
    for (int j = 0; j < kUnknowns; ++j)
      for (int k = 0; k <= kUnknowns; ++k) equations[j][k] += row[j] * row[k];
  }
  for (int j = 0; j < kUnknowns; ++j) equations[j][j] += kRidge;
  const auto x = solved(equations);
  const double w2 = widest * widest, w3 = w2 * widest;
  d.k1 = x[0] / widest, d.k2 = x[1] / w2, d.k3 = x[2] / w3;
  d.k4 = x[3] / widest, d.k5 = x[4] / w2, d.k6 = x[5] / w3;
  LensFit out{d, 0};
  for (int i = 1; i <= kSamples; ++i) {
    const double r = radius * i / kSamples;
    out.residual = std::max(out.residual, r * std::abs(rational(d, r * r) - radial(lens, r * r)));
  }
  return out;
}

}  // namespace fourdvt::capture

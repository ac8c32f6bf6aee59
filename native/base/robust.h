// SPDX-License-Identifier: Apache-2.0
// Robust statistics.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace fourdvt {

// Median; the upper of the two middle values of an even number.
template <class T>
T median(std::vector<T> values, T of_none = 0) {
  if (values.empty()) return of_none;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Quantile at `share`, interpolated; 0 for no values.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const double at = share * double(values.size() - 1);
  const auto lower = values.begin() + static_cast<std::ptrdiff_t>(at);
  std::nth_element(values.begin(), lower, values.end());
  const auto next = std::min_element(lower + 1, values.end());
  if (next == values.end()) return *lower;
  return *lower + (at - std::floor(at)) * (*next - *lower);
}

constexpr double kDegrees = 180 / 3.14159265358979323846;  // degrees per radian

// Standard deviation of the normal distribution with the same median absolute value.
inline double robustScale(const std::vector<double>& values) {
  std::vector<double> sizes;
  sizes.reserve(values.size());
  for (const double v : values) sizes.push_back(std::abs(v));
  return 1.4826 * quantile(std::move(sizes), 0.5);
}

// Tukey's biweight of a residual in standard deviations: 1 at 0, 0 from 4.685 on.
inline double tukeyWeight(double deviations) {
  const double x = deviations / 4.685;
  return std::abs(x) < 1 ? (1 - x * x) * (1 - x * x) : 0;
}

}  // namespace fourdvt

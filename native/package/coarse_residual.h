// SPDX-License-Identifier: Apache-2.0
// Residuals in steps that are larger than those of the values, with a dead zone. Encoders only: a decoder sees ordinary
// residuals. Internal to package/.
#pragma once

#include <cmath>
#include <glm/glm.hpp>

namespace fourdvt::package {

// Share of a step up to which a residual counts as 0, and by which larger ones are drawn towards 0: half of the bytes
// of rounding, for errors that are at most 0.3 steps larger.
constexpr double kDeadZone = 0.8;

// value: in steps of its own; predicted: in steps that are `scale` times as large, as is the result.
template <int N>
glm::ivec3 coarseResidual(const glm::vec<N, int>& value, double scale, const glm::ivec3& predicted) {
  glm::ivec3 out(0);
  for (int k = 0; k < N; ++k) {
    const double residual = value[k] / scale - predicted[k];
    const int magnitude = static_cast<int>(std::floor(std::abs(residual) + (1 - kDeadZone)));
    out[k] = residual < 0 ? -magnitude : magnitude;
  }
  return out;
}

}  // namespace fourdvt::package

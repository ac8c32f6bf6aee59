// SPDX-License-Identifier: Apache-2.0
#include "base/length_scale.h"

#include <algorithm>
#include <cmath>

#include "base/robust.h"

namespace fourdvt {
namespace {

constexpr double kPerson_m = 2;  // mid-range size of a person's surface, arms raised to crouching

}  // namespace

double longestSide(const Positions& positions) {
  glm::vec3 low = positions[0], high = low;
  for (const glm::vec3& p : positions) low = glm::min(low, p), high = glm::max(high, p);
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

double lengthScale(std::vector<double> longest_sides_m) {
  const double usual_m = median(std::move(longest_sides_m));
  return usual_m > 0 ? std::exp2(std::round(std::log2(usual_m / kPerson_m))) : 1;
}

}  // namespace fourdvt

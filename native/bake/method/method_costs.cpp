// SPDX-License-Identifier: Apache-2.0
#include "bake/method/method_costs.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace fourdvt::bake {
namespace {

struct Cost {
  const char* method;
  double at[3];  // by kFaces
};

#include "bake/method/method_costs.inc"

}  // namespace

double methodCost(std::string_view method, size_t faces) {
  const auto row =
      std::find_if(std::begin(kCosts), std::end(kCosts), [&](const Cost& c) { return method == c.method; });
  if (row == std::end(kCosts)) return std::numeric_limits<double>::infinity();
  const double at = std::log(double(std::clamp(faces, kFaces[0], kFaces[2])));
  const size_t k = faces < kFaces[1] ? 0 : 1;
  const double low = std::log(double(kFaces[k])), high = std::log(double(kFaces[k + 1]));
  return std::max(1.0, row->at[k] + (row->at[k + 1] - row->at[k]) * (at - low) / (high - low));
}

bool trustsCalibration(std::string_view method) { return method == "sweep"; }

std::vector<std::string> methodCandidates() {
  std::vector<std::string> out;
  for (const Cost& cost : kCosts) out.emplace_back(cost.method);
  return out;
}

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
#include "player/parts/parameters.h"

#include <algorithm>
#include <cmath>

namespace fourdvt {

double Parameters::wanted(const package::Sequence& sequence, size_t parameter) const {
  const motion::Range range = motion::parameterRange(sequence, parameter);
  const auto set = wanted_.find(sequence.space.names[parameter]);
  const std::vector<double>& first = sequence.members[0].parameter;
  const double value = set != wanted_.end() ? set->second : parameter < first.size() ? first[parameter] : range.min;
  return std::clamp(value, range.min, range.max);
}

std::vector<double> parametersAt(const package::Sequence& sequence, const std::vector<float>& weights) {
  const package::ParameterSample* nearest = nullptr;
  float min_distance = 1e30f;
  for (const package::ParameterSample& sample : sequence.space.samples) {
    float distance = 0;
    for (size_t m = 0; m < weights.size(); ++m) distance += std::abs(weights[m] - sample.weights[m]);
    if (distance >= min_distance) continue;
    min_distance = distance;
    nearest = &sample;
  }
  return nearest ? nearest->at : std::vector<double>{};
}

void ShownParameters::enter(const package::Sequence& sequence, const Parameters& parameters) {
  values_ = std::move(entry_);
  entry_.clear();
  for (size_t p = values_.size(); p < sequence.space.names.size(); ++p)
    values_.push_back(parameters.wanted(sequence, p));
  weights_ = motion::weightsAt(sequence, values_);
}

bool ShownParameters::glide(const package::Sequence& sequence, const Parameters& parameters, double dt_s) {
  bool moved = false;
  for (size_t p = 0; p < values_.size(); ++p) {
    const motion::Range range = motion::parameterRange(sequence, p);
    const double max_step = (range.max - range.min) * parameters.rate() * dt_s;
    const double step = std::clamp(parameters.wanted(sequence, p) - values_[p], -max_step, max_step);
    values_[p] += step;
    moved |= step != 0;
  }
  if (moved) weights_ = motion::weightsAt(sequence, values_);
  return moved;
}

}  // namespace fourdvt

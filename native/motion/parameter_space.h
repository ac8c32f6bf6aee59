// SPDX-License-Identifier: Apache-2.0
// Parameter values ("2.1 m/s") → what to blend. Pure logic on the manifest's tables (package/character.h).
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "package/character.h"

namespace fourdvt::motion {

struct BlendWeights {
  std::vector<float> members;  // sum 1
  std::vector<float> offsets;  // coefficients of the references
};

// Gives one member the whole weight.
BlendWeights memberWeights(const package::Sequence& sequence, size_t member);
// The weights at the point of the space's simplices that lies nearest to `at`. A plain sequence has {1}. `at`: one
// value per parameter.
BlendWeights weightsAt(const package::Sequence& sequence, std::span<const double> at);
struct Range {
  double min = 0, max = 0;
};
Range parameterRange(const package::Sequence& sequence, size_t parameter);
int findParameter(const package::Sequence& sequence, std::string_view name);  // -1: no parameter has that name
// Duration of one pass at these weights of the members; durations mix linearly.
double durationAt(const package::Sequence& sequence, std::span<const float> members);

}  // namespace fourdvt::motion

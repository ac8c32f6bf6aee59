// SPDX-License-Identifier: Apache-2.0
// A class's table from parameter values to weights (package::ParameterSpace): "2.1 m/s" is the speed that the mixed
// travel and duration give, not a mix of speeds.
#pragma once

#include <string>
#include <vector>

#include "bake/motion/hybrid_blend.h"

namespace fourdvt::bake {

// A simplex with the references chosen for it.
struct HybridSimplex {
  BlendSimplex corners;
  int segments = 1;
  std::vector<Shares> nodes;
  std::vector<size_t> references;  // [node] in ClassPlan::reference_weights
};

// Simplices of members by their parameters (Member::parameter): neighbours in order, or triangles. Errors: CaptureJson:
// equal or collinear members.
Result<std::vector<BlendSimplex>> classSimplices(const std::vector<package::Member>& members, const std::string& name);

HybridMix mixOf(const BlendSimplex& simplex);
// measured: [parameter] a speed that follows from travel and duration; else values mix linearly.
package::ParameterSpace parameterTable(const std::vector<package::Member>& members,
                                       const std::vector<std::string>& names, const std::vector<bool>& measured,
                                       const std::vector<HybridSimplex>& simplices, size_t reference_count);

double speedOf(const package::Member& member);  // m/s of a whole pass

}  // namespace fourdvt::bake

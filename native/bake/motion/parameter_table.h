// SPDX-License-Identifier: Apache-2.0
// Tabulates which weights a class needs for a parameter's value (package::ParameterSpace). "2.1 m/s" is the speed that
// the mixed travel and the mixed duration give, not a mix of speeds.
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
  std::vector<size_t> references;  // [node] index in ClassPlan::reference_weights
};

// Simplices of members by Member::parameter: intervals between neighbours, or triangles. place: "capture.json: class
// 'x'", for messages. Errors: CaptureJson (members with equal or collinear parameters).
Result<std::vector<BlendSimplex>> classSimplices(const std::vector<package::Member>& members, const std::string& place);

HybridMix mixOf(const BlendSimplex& simplex);
// measured: [parameter] true for a speed that follows from travel and duration; other values mix linearly.
package::ParameterSpace parameterTable(const std::vector<package::Member>& members,
                                       const std::vector<std::string>& names, const std::vector<bool>& measured,
                                       const std::vector<HybridSimplex>& simplices, size_t reference_count);

double speedOf(const package::Member& member);  // mean speed of a whole pass, m/s

}  // namespace fourdvt::bake

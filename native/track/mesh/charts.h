// SPDX-License-Identifier: Apache-2.0
// Cuts a surface into small, nearly flat, connected sets of faces, from which glue.h makes the charts.
#pragma once

#include "track/mesh/surface.h"

namespace fourdvt::track {

using FaceSet = std::vector<uint32_t>;  // faces of the surface, each once

// Returns about `count` connected sets that together hold every face once.
std::vector<FaceSet> grownSets(const Surface& surface, int count);

// Splits a set of two faces or more into at least two connected ones.
std::vector<FaceSet> halves(const Surface& surface, const FaceSet& set);

}  // namespace fourdvt::track

// SPDX-License-Identifier: Apache-2.0
// The motion graph of the whole character: states are its streams in the manifest's order.
#pragma once

#include "bake/run/bake_run.h"

namespace fourdvt::bake {

// Weights at which a class's transitions are measured: every member alone, and three mixtures of every pair that lies
// side by side (one parameter: neighbours by its value; two: all pairs). A plain sequence: {{1}}.
std::vector<std::vector<float>> graphWeights(const ClassPlan& plan);

// Bytes of the graph file; none for a character of one stream. Needs every GOP. Errors: those of capture, Interrupted.
Result<std::vector<uint8_t>> makeGraph(BakeRun& run);

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Builds the motion graph of the whole character. Its states are the streams in the manifest's order.
#pragma once

#include "bake/run/bake_run.h"

namespace fourdvt::bake {

// The weights at which transitions of a class are measured: every member alone, and three mixtures of every pair of
// neighbours (with one parameter, neighbours by its value; with two, all pairs). For a plain sequence: {{1}}.
std::vector<std::vector<float>> graphWeights(const ClassPlan& plan);

// Returns the bytes of the graph's file, empty for a character of one stream. Kept in the work folder. Needs all GOPs
// to be finished. Errors: those of capture, Interrupted.
Result<std::vector<uint8_t>> makeGraph(BakeRun& run);

}  // namespace fourdvt::bake

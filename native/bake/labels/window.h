// SPDX-License-Identifier: Apache-2.0
// Frames whose labels a rule (Labelling::solve) solves together.
#pragma once

#include <vector>

#include "bake/labels/expansion.h"

namespace fourdvt::bake {

struct WindowFrame {
  const FaceCosts* costs = nullptr;           // borrowed
  std::vector<LabelTuple>* labels = nullptr;  // borrowed; out
  bool frozen = false;                        // its labels do not change
  bool solved = false;                        // its labels come from another window and are to be improved
};

// Labels every face with its cheapest cameras that see it.
void labelByPenalty(const FaceCosts& costs, int layers, std::vector<LabelTuple>& labels);

}  // namespace fourdvt::bake

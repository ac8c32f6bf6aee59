// SPDX-License-Identifier: Apache-2.0
// Solves the labels of neighbouring frames together, as the mode asks.
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

void solveWindow(const LabelOptions& options, const FaceLinks& links, std::vector<WindowFrame>& frames);

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Labels of neighbouring frames solved together, by mode.
#pragma once

#include <vector>

#include "bake/labels/expansion.h"

namespace fourdvt::bake {

struct WindowFrame {
  const FaceCosts* costs = nullptr;           // borrowed
  std::vector<LabelTuple>* labels = nullptr;  // borrowed; out
  bool frozen = false;                        // labels stay
  bool solved = false;                        // labels come from another window; improve them
};

void solveWindow(const LabelOptions& options, const FaceLinks& links, std::vector<WindowFrame>& frames);

}  // namespace fourdvt::bake

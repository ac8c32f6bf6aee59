// SPDX-License-Identifier: Apache-2.0
// How near the windowed labelling comes to one solve of the whole sequence.
#pragma once

#include "study/study.h"

namespace fourdvt::study {

// Table "labels", method joint, setting solve=global and solve=windowed: energy of the first frames of the shortest
// sequence, at most kGlobalFrames (a global solve holds all its frames).
constexpr uint32_t kGlobalFrames = 32;
Result<Figures> compareSolves(const StudyContext& context);

}  // namespace fourdvt::study

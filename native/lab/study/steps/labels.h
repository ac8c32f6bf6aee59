// SPDX-License-Identifier: Apache-2.0
// What labelling alone gains, without a bake: compares the modes on the same costs, the joint mode without each of its
// two liberties, and its windowed solve with one solve of the whole sequence. Does NOT measure pictures.
#pragma once

#include <string>

#include "bake/labels/labelling.h"
#include "lab/study/run/context.h"

namespace fourdvt::study {

// On the first frames of the shortest sequence, at most kGlobalFrames (a global solve holds all its frames;
// kQuickFrames with `quick`): table "label-parts": every mode, and joint without partial cameras, without labels on
// unseen faces, without both; table "labels", method joint, setting solve=global and solve=windowed: energy (not with
// `quick`).
constexpr uint32_t kGlobalFrames = 32, kQuickFrames = 6;
Result<Rows> measureLabels(const StudyContext& context);

// Seams, flips and penalties per layer, as rows of a table.
void writeLabelRows(const bake::LabelStatistics& statistics, const std::string& table, const std::string& sequence,
                    const std::string& method, Rows& out);

}  // namespace fourdvt::study

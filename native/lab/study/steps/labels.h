// SPDX-License-Identifier: Apache-2.0
// Labelling without a bake: compares the modes on the same costs, the joint mode without each of its two relaxations,
// and its windowed solve with one solve of the whole sequence. Pictures are not measured.
#pragma once

#include <string>

#include "bake/labels/labelling.h"
#include "lab/study/run/context.h"

namespace fourdvt::study {

// Runs on the first frames of the shortest sequence, at most kGlobalFrames (a global solve holds all its frames;
// kQuickFrames with `quick`). Table "label-parts": each mode, and joint without partial cameras, without labels on
// unseen faces, without both; table "labels", method joint, setting solve=global and solve=windowed: energy (not with
// `quick`).
constexpr uint32_t kGlobalFrames = 32, kQuickFrames = 6;
Result<Rows> measureLabels(const StudyContext& context);

// Writes seams, flips and penalties per layer as rows of a table.
void writeLabelRows(const bake::LabelStatistics& statistics, const std::string& table, const std::string& sequence,
                    const std::string& method, Rows& out);

}  // namespace fourdvt::study

// SPDX-License-Identifier: Apache-2.0
// The papers' rules by which faces take their cameras and texels theirs, for comparison with the bake's own.
#pragma once

#include <span>
#include <string_view>

#include "bake/labels/labelling.h"
#include "bake/run/options.h"

namespace fourdvt::lab {

extern const bake::Labelling kNaive;    // "NO": cameras by penalty, each face and frame by itself
extern const bake::Labelling kSpatial;  // "SO", 4DVT Eq. 2-4: each frame alone; layer after layer, cameras distinct
extern const bake::Labelling kTemporalPaper;  // "TO", 4DVT Eq. 5 literally: the temporal term carries the weight 1/|M|
// Labels as kNaive, and each texel from the next camera that sees it (per_texel.h); weights stay per face, unlike
// LVDT's.
extern const bake::Labelling kPerTexel;

// The papers' rules and bake::kJoint.
std::span<const bake::Labelling* const> allLabellings();
// Null: there is no such name.
const bake::Labelling* findLabelling(std::string_view name);
// Sets the labelling, and the choice of texels that goes with it.
void useLabelling(const bake::Labelling& rule, bake::BakeOptions& options);

}  // namespace fourdvt::lab

// SPDX-License-Identifier: Apache-2.0
// The papers' camera labellings of faces and texels, for comparison with the bake's own. Casas, Volino, Collomosse,
// Hilton: 4D Video Textures for Interactive Character Appearance, Computer Graphics Forum 33(2), 2014.
#pragma once

#include <span>
#include <string_view>

#include "bake/labels/labelling.h"
#include "bake/run/options.h"

namespace fourdvt::lab {

extern const bake::Labelling kNaive;    // "NO": cameras by penalty, per face and frame
extern const bake::Labelling kSpatial;  // "SO", Casas et al. 2014 Eq. 2-4: per frame, layer by layer, distinct cameras
extern const bake::Labelling kTemporalPaper;  // "TO", Casas et al. 2014 Eq. 5 literally: temporal weight 1/|M|
// Labels as kNaive, and each texel from the next camera in which it is visible (per_texel.h); weights stay per face,
// unlike Volino and Hilton's.
extern const bake::Labelling kPerTexel;

// The papers' rules and bake::kJoint.
std::span<const bake::Labelling* const> allLabellings();
// Returns null for an unknown name.
const bake::Labelling* findLabelling(std::string_view name);
// Sets the labelling and its texel rule.
void useLabelling(const bake::Labelling& rule, bake::BakeOptions& options);

}  // namespace fourdvt::lab

// SPDX-License-Identifier: Apache-2.0
// Capture folder → character folder. bake/run/stage_table.h lists the stages in order of execution, bake/stages/ holds
// them. The bake looks at the pictures three times: the refinement makes mesh and cameras agree with them, in up to 40
// frames; the survey measures visibility and colours, from which the labels of whole sequences follow; then every GOP
// is resampled, filled, tiled and encoded. A character from cameras has no survey and no labels: its GOPs are crops of
// the pictures, and surfaces.
//
// Does NOT decide how frames are shown. Memory: one frame of pictures and one GOP of packets and meshes, whatever the
// length; while refining, the mattes and meshes of its frames (refine/frames.h); for classes also 12 bytes per vertex,
// phase and further member, for the alignment over the whole motion.
#pragma once

#include "bake/run/environment.h"
#include "bake/run/figures.h"
#include "bake/run/options.h"
#include "base/result.h"

namespace fourdvt::bake {

Result<BakeReport> bake(const BakeOptions& options, const BakeEnvironment& environment);

}  // namespace fourdvt::bake

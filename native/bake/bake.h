// SPDX-License-Identifier: Apache-2.0
// Capture folder → character folder. bake/run/stage_table.h lists the stages in order of execution, bake/stages/ holds
// them. The bake looks at the pictures twice: first the survey measures visibility and colours, from which the labels
// of whole sequences follow; then every GOP is resampled, filled, tiled and encoded.
//
// Does NOT decide how frames are shown. Memory: one frame of pictures and one GOP of packets and meshes, whatever the
// length; for classes also 12 bytes per vertex, phase and further member, for the alignment over the whole motion.
#pragma once

#include "bake/run/environment.h"
#include "bake/run/figures.h"
#include "bake/run/options.h"
#include "base/result.h"

namespace fourdvt::bake {

Result<BakeReport> bake(const BakeOptions& options, const BakeEnvironment& environment);

}  // namespace fourdvt::bake

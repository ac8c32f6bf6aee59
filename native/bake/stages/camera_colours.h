// SPDX-License-Identifier: Apache-2.0
// The "colours" stage of a character from cameras: makes the cameras' colours agree, as the survey does for layers, on
// surfaces whose topology may change.
#pragma once

#include "bake/run/bake_run.h"
#include "bake/texels/colour_calibration.h"

namespace fourdvt::bake {

// One map per camera; empty if colours are not to be calibrated. Kept in the survey folder. Errors: those of capture
// and GPU, WriteFailed, Interrupted.
Result<std::vector<ColourMap>> calibrateColours(BakeRun& run);

}  // namespace fourdvt::bake

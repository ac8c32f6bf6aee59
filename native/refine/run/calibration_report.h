// SPDX-License-Identifier: Apache-2.0
// A calibration for people and for programs: text, calibrate.html, calibrate.json. Does NOT measure.
#pragma once

#include <string>

#include "refine/silhouettes/calibration.h"

namespace fourdvt::refine {

// One line a camera that is off, "cam03 is off by −2.08 ± 0.01 frames in "walk"", or one line that none is, or that
// nothing was changed; the warnings are not among them.
std::vector<std::string> calibrationLines(const Calibration& calibration);

// Errors: WriteFailed. `name`: of the capture, for the title.
Status writeCalibrationReport(const std::string& folder, const std::string& name, const Calibration& calibration);

}  // namespace fourdvt::refine

// SPDX-License-Identifier: Apache-2.0
// Command `fourdvt calibrate`: estimates cameras' times and poses from silhouettes, writes a capture folder with them,
// and reports the result as text, calibrate.html and calibrate.json.
//   pictures, mattes or plates → capture.json ("offset_frames", "first_frame", "frames"), a calibration, a report
// All other entries of the folder are links. The folder is put into place once it is complete.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "refine/silhouettes/calibration.h"

namespace fourdvt::refine {
inline constexpr const char* kCalibrationJson = "calibrate.json";
inline constexpr const char* kCalibrationHtml = "calibrate.html";

struct CalibrateOptions {
  std::string capture_folder, folder;  // input, output; without output folder only measures
  std::vector<std::string> sequences;  // empty: all
  std::vector<std::string> leave_out;  // cameras
  CalibrationOptions calibration;
  int jobs = 0;  // threads; 0: one per core
};

// Errors: those of openCapture, calibrate and linkCapture; WriteFailed.
Result<Calibration> calibrateCapture(const CalibrateOptions& options, const OpenVideo& open_video,
                                     const std::function<bool(const std::string& what, double share)>& on_progress);

// One line for each change of a camera's time or pose, e.g. "cam03 is off by −2.08 ± 0.01 frames in "walk""; without
// changes, one line that reports this. Excludes the warnings.
std::vector<std::string> calibrationLines(const Calibration& calibration);

// Errors: WriteFailed. `name`: capture name for the title.
Status writeCalibrationReport(const std::string& folder, const std::string& name, const Calibration& calibration);

}  // namespace fourdvt::refine

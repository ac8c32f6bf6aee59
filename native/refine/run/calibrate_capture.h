// SPDX-License-Identifier: Apache-2.0
// `fourdvt calibrate`: measures cameras' times and poses from silhouettes, and writes a capture folder that has them.
//   pictures, mattes or plates → capture.json ("offset_frames", "first_frame", "frames"), a calibration, a report
// Everything else in the folder is links. Nothing is put into place before all is there.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "refine/silhouettes/calibration.h"

namespace fourdvt::refine {
inline constexpr const char* kCalibrationJson = "calibrate.json";
inline constexpr const char* kCalibrationHtml = "calibrate.html";

struct CalibrateOptions {
  std::string capture_folder, folder;  // read, written; no folder: only measured
  std::vector<std::string> sequences;  // empty: all
  std::vector<std::string> leave_out;  // cameras
  CalibrationOptions calibration;
  int jobs = 0;  // threads; 0: one per core
};

// Errors: those of openCapture, calibrate and linkCapture; WriteFailed.
Result<Calibration> calibrateCapture(const CalibrateOptions& options, const OpenVideo& open_video,
                                     const std::function<bool(const std::string& what, double share)>& on_progress);

// A calibration for people and for programs: text, calibrate.html, calibrate.json. Does NOT measure.

// One line a camera that is off, "cam03 is off by −2.08 ± 0.01 frames in "walk"", or one line that none is, or that
// nothing was changed; the warnings are not among them.
std::vector<std::string> calibrationLines(const Calibration& calibration);

// Errors: WriteFailed. `name`: of the capture, for the title.
Status writeCalibrationReport(const std::string& folder, const std::string& name, const Calibration& calibration);

}  // namespace fourdvt::refine

// SPDX-License-Identifier: Apache-2.0
// Finds and reads the calibration that a file is, or that lies in a folder. Reads at most 64 MB of any file.
#pragma once

#include "capture/import/imported.h"

namespace fourdvt::capture {

// The formats, one a line, for messages and help: "Qualisys (NAME.qca.txt)".
std::string knownCalibrations();

// Errors: FileMissing, FileUnreadable (no calibration of a known kind: the message lists them, or one that is cut off
// or too large), CameraModel, CameraPose (also two cameras of one name).
Result<ImportedCalibration> readCalibration(const std::string& source);

}  // namespace fourdvt::capture

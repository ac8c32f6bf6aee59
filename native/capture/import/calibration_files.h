// SPDX-License-Identifier: Apache-2.0
// Finds and reads the calibration in a file or folder. Reads at most 64 MB of any file.
#pragma once

#include "capture/import/imported.h"

namespace fourdvt::capture {

// Supported formats, one per line, for messages and help: "Qualisys (NAME.qca.txt)".
std::string knownCalibrations();

// Reads the calibration of a supported format. Errors: FileMissing, FileUnreadable (no supported format: the message
// lists them; truncated or too large), CameraModel, CameraPose (also two cameras of one name).
Result<ImportedCalibration> readCalibration(const std::string& source);

}  // namespace fourdvt::capture

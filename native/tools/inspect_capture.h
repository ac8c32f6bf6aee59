// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "base/result.h"

namespace fourdvt::tools {

// True for a folder with a capture.json.
bool isCaptureFolder(const std::string& path);

// Prints, per sequence and camera, the pictures that a capture has, the marks that their files have and what reading
// makes of them, and where mattes come from. Returns the command's exit code: 1 if a file cannot be used.
Result<int> inspectCapture(const std::string& folder);

}  // namespace fourdvt::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "base/result.h"

namespace fourdvt::tools {

// Returns true for a folder with a capture.json.
bool isCaptureFolder(const std::string& path);

// Prints, per sequence and camera, the pictures of a capture, their files' marks and the conversions applied, and the
// source of mattes. Returns the command's exit code: 1 if a file cannot be used.
Result<int> inspectCapture(const std::string& folder);

}  // namespace fourdvt::tools

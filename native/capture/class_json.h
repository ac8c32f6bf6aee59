// SPDX-License-Identifier: Apache-2.0
// The "classes" of capture.json: motions that are one motion with a parameter. Does NOT measure parameters.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "capture/capture_json.h"

namespace fourdvt::capture {

// `list`: the value of "classes", null if there is none. `file`: path of capture.json, for messages. Errors:
// CaptureJson.
Result<std::vector<CaptureClass>> parseClasses(const nlohmann::json& list,
                                               const std::vector<DeclaredSequence>& sequences, const std::string& file);

}  // namespace fourdvt::capture

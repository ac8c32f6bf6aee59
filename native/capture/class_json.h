// SPDX-License-Identifier: Apache-2.0
// The "classes" of capture.json: motions that are one motion with a parameter. Does NOT measure parameters.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "capture/capture_json.h"

namespace fourdvt::capture {

inline constexpr size_t kMinMembers = 2, kMaxMembers = 4;  // of a class

// `list`: the value of "classes", null if there is none. `file`: path of capture.json, for messages. Errors:
// CaptureJson.
Result<std::vector<CaptureClass>> parseClasses(const nlohmann::json& list,
                                               const std::vector<DeclaredSequence>& sequences, const std::string& file);

// The value of "classes" that parseClasses reads as these, without footsteps.
nlohmann::ordered_json classesJson(const std::vector<CaptureClass>& classes);

}  // namespace fourdvt::capture

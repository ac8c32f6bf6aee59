// SPDX-License-Identifier: Apache-2.0
// "classes" of capture.json: motions with a common parameter, as declared.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "capture/capture_json.h"

namespace fourdvt::capture {

inline constexpr size_t kMinMembers = 2, kMaxMembers = 4;  // members per class

// `list`: value of "classes", null without one. `file`: path of capture.json, for messages. Errors: CaptureJson.
Result<std::vector<CaptureClass>> parseClasses(const nlohmann::json& list,
                                               const std::vector<DeclaredSequence>& sequences, const std::string& file);

// Value of "classes" from which parseClasses reads `classes`, without footsteps.
nlohmann::ordered_json classesJson(const std::vector<CaptureClass>& classes);

}  // namespace fourdvt::capture

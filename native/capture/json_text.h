// SPDX-License-Identifier: Apache-2.0
// Parser for hand-written JSON; errors name the line.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "base/result.h"

namespace fourdvt::capture {

// Skips a byte order mark. Error `id`, beginning with `path` and the line: invalid JSON (a decimal comma and NaN are
// named as such), or nesting deeper than 64, since JSON writers recurse as deep.
Result<nlohmann::json> parseJsonText(std::string_view text, const std::string& path, ErrorId id);

// Returns true for well-formed UTF-8, which JSON can hold.
bool isUtf8(std::string_view text);

}  // namespace fourdvt::capture

// SPDX-License-Identifier: Apache-2.0
// Parses a JSON text that people wrote: what is wrong is named with its line.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "base/result.h"

namespace fourdvt::capture {

// A byte order mark is skipped. Error `id`, beginning with `path` and the line: no JSON (a decimal comma and NaN are
// named as such), or nested deeper than 64, which would make writers of JSON recurse as deep.
Result<nlohmann::json> parseJsonText(std::string_view text, const std::string& path, ErrorId id);

// Returns true for well-formed UTF-8, which JSON can hold.
bool isUtf8(std::string_view text);

}  // namespace fourdvt::capture

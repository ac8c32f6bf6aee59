// SPDX-License-Identifier: Apache-2.0
// Parsing of user-supplied XML: places of errors, and numbers in texts.
#pragma once

#include <pugixml.hpp>
#include <string>
#include <vector>

#include "base/result.h"

namespace fourdvt::capture {

// Parses a document. Errors: FileUnreadable, with the line.
Status loadXml(const std::string& text, const std::string& path, pugi::xml_document& document);
// Location "path:line: " of a node.
std::string placeOf(const pugi::xml_node& node, const std::string& text, const std::string& path);
// Parses exactly `wanted` finite numbers, separated by blanks. `what` begins the message's reason. Errors: CameraPose.
Result<std::vector<double>> xmlNumbers(const char* given, size_t wanted, const std::string& what);

}  // namespace fourdvt::capture

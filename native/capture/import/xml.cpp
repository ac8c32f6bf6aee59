// SPDX-License-Identifier: Apache-2.0
#include "capture/import/xml.h"

#include <algorithm>

#include "capture/text.h"

namespace fourdvt::capture {

Status loadXml(const std::string& text, const std::string& path, pugi::xml_document& document) {
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (parsed) return {};
  const int line = lineOfByte(text, static_cast<size_t>(std::max<ptrdiff_t>(parsed.offset, 0)));
  return Error{ErrorId::FileUnreadable,
               atLine(path, line) + "not valid XML (" + parsed.description() + "); export the calibration again"};
}

std::string placeOf(const pugi::xml_node& node, const std::string& text, const std::string& path) {
  return atLine(path, lineOfByte(text, static_cast<size_t>(std::max<ptrdiff_t>(node.offset_debug(), 0))));
}

Result<std::vector<double>> xmlNumbers(const char* given, size_t wanted, const std::string& what) {
  std::string words = given;
  std::replace_if(
      words.begin(), words.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  Fields fields(words);
  std::vector<double> out;
  while (out.size() < wanted && fields.problem().empty()) out.push_back(fields.number<double>());
  if (fields.problem().empty() && fields.rest().empty()) return out;
  return Error{ErrorId::CameraPose, what + " must be " + std::to_string(wanted) + " numbers" +
                                        (fields.problem().empty() ? "" : ", but " + fields.problem()) +
                                        "; export the calibration again"};
}

}  // namespace fourdvt::capture

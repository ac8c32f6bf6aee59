// SPDX-License-Identifier: Apache-2.0
#include "capture/json_text.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "capture/text.h"

namespace fourdvt::capture {
namespace {

using Json = nlohmann::json;
constexpr int kMaxDepth = 64;

// Letters, digits, signs, points and commas around byte `at`.
std::string_view wordAround(std::string_view text, size_t at) {
  constexpr std::string_view kSigns = "+-.,";
  const auto inWord = [&](size_t i) {
    return std::isalnum(static_cast<unsigned char>(text[i])) || kSigns.find(text[i]) != kSigns.npos;
  };
  size_t begin = std::min(at, text.size()), end = begin;
  while (begin > 0 && inWord(begin - 1)) --begin;
  while (end < text.size() && inWord(end)) ++end;
  std::string_view word = text.substr(begin, end - begin);
  while (word.ends_with(',')) word.remove_suffix(1);
  return word;
}

std::string reasonAt(std::string_view text, size_t at) {
  const std::string_view word = wordAround(text, at);
  std::string small(word.substr(0, 9));
  std::transform(small.begin(), small.end(), small.begin(), [](unsigned char c) { return std::tolower(c); });
  if (hasDecimalComma(word) || toNumber<double>(small)) return numberProblem(word);
  return "not valid JSON; check commas, quotes and brackets";
}

}  // namespace

bool isUtf8(std::string_view text) {
  using Handler = nlohmann::detail::error_handler_t;
  const Json json(text);
  return json.dump(-1, ' ', false, Handler::ignore) == json.dump(-1, ' ', false, Handler::replace);
}

Result<Json> parseJsonText(std::string_view text, const std::string& path, ErrorId id) {
  text = skipByteOrderMark(text);
  bool deep = false;
  const auto shallow = [&](int depth, Json::parse_event_t, const Json&) { return !(deep |= depth > kMaxDepth); };
  try {
    Json root = Json::parse(text.begin(), text.end(), shallow);
    if (deep) return Error{id, path + ": nested deeper than 64; take such fields out"};
    return root;
  } catch (const Json::parse_error& error) {
    const size_t at = error.byte > 0 ? error.byte - 1 : 0;
    return Error{id, atLine(path, lineOfByte(text, at)) + reasonAt(text, at)};
  } catch (const Json::exception&) {  // out of range
    return Error{id, path + ": not valid JSON; check its numbers"};
  }
}

}  // namespace fourdvt::capture

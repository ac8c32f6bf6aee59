// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <cmath>
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
  if (hasDecimalComma(word) || toNumber<double>(lowerCase(std::string(word.substr(0, 9))))) return numberProblem(word);
  return "not valid JSON; check commas, quotes and brackets";
}

}  // namespace

const Json& jsonMember(const Json& node, const char* key) {
  static const Json null;
  if (!node.is_object()) return null;
  const auto it = node.find(key);
  return it == node.end() ? null : *it;
}

bool jsonNumbers(const Json& node, size_t count, double* out, double max) {
  if (!node.is_array() || node.size() != count) return false;
  for (size_t i = 0; i < count; ++i) {
    if (!node[i].is_number() || !(std::abs(node[i].get<double>()) <= max)) return false;
    out[i] = node[i].get<double>();
  }
  return true;
}

std::string jsonText(const Json& node, const std::string& otherwise) {
  return node.is_string() ? node.get<std::string>() : otherwise;
}

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

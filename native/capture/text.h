// SPDX-License-Identifier: Apache-2.0
// Lines, words and numbers of text files, values of JSON, and diagnostics for malformed ones; common to all text
// readers. Independent of the locale. Lines end in LF, CRLF or CR; a byte order mark before the text is skipped; words
// are separated by spaces and tabs. Texts are borrowed.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "base/result.h"

namespace fourdvt::capture {

// Whole file as text; nullopt if it cannot be opened or read.
std::optional<std::string> readText(const std::string& path);

// Text without the byte order mark (UTF-8) that some editors prepend.
inline std::string_view skipByteOrderMark(std::string_view text) {
  return text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text;
}

// Takes the next line off `text`, without its end; false at the end of the text.
inline bool takeLine(std::string_view& text, std::string_view& line) {
  if (text.empty()) return false;
  size_t end = 0;
  while (end < text.size() && text[end] != '\n' && text[end] != '\r') ++end;
  line = text.substr(0, end);
  if (text.substr(end).starts_with("\r\n")) ++end;
  text.remove_prefix(end < text.size() ? end + 1 : end);
  return true;
}

// Takes the next blank-separated word off `line`; empty at the end.
inline std::string_view takeWord(std::string_view& line) {
  const size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return line = {};
  const size_t end = line.find_first_of(" \t", begin);
  const std::string_view word = line.substr(begin, end == std::string_view::npos ? end : end - begin);
  line.remove_prefix(end == std::string_view::npos ? line.size() : end);
  return word;
}

// Text without the blanks at both ends.
std::string_view trimmed(std::string_view text);

inline bool isDigit(char c) { return c >= '0' && c <= '9'; }
std::string lowerCase(std::string text);  // ASCII only
// Extension of a path in lower case, with its dot.
std::string lowerExtension(const std::string& path);

inline std::span<const uint8_t> bytesOf(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

// Whole word as a number ("nan" and "inf" count as numbers), else nullopt.
template <class T>
std::optional<T> toNumber(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

// Returns true for "1,5" and the like: a number with a decimal comma.
bool hasDecimalComma(std::string_view word);
// Reason for a word that is no finite number, with the remedy: "1,5" has a decimal comma (write 1.5, not 1,5).
std::string numberProblem(std::string_view word);

// Remark on a list with too many numbers, where "1,5" counts as two. Empty if `count` is at most `wanted`.
std::string tooManyNumbers(size_t count, size_t wanted);

// Line number, from 1, of a byte of the text.
int lineOfByte(std::string_view text, size_t byte);

// Prefix of a message about line `number` of a file: "path:number: ".
std::string atLine(const std::string& path, int number);

// Words of one line, in order.
class Fields {
 public:
  explicit Fields(std::string_view line) : rest_(line) {}
  std::string_view word() { return takeWord(rest_); }
  // Returns the next word as a finite number; otherwise 0, and problem() gives the reason.
  template <class T>
  T number() {
    const std::string_view given = word();
    const auto value = toNumber<T>(given);
    bool fits = value.has_value();
    if constexpr (std::is_floating_point_v<T>) fits = fits && std::isfinite(*value);
    if (fits) return *value;
    if (problem_.empty()) problem_ = numberProblem(given);
    return {};
  }
  // Rest of the line, including blanks within it.
  std::string_view rest() const { return trimmed(rest_); }
  // Reason for the first word that is no number; empty if all were.
  const std::string& problem() const { return problem_; }

 private:
  std::string_view rest_;
  std::string problem_;
};

// Non-empty lines of a text.
class TextLines {
 public:
  struct Rules {
    char comment = '#';           // begins a skipped line; 0: none
    bool comment_behind = false;  // also ends a line behind a blank
    bool continued = false;       // a trailing backslash continues the line
    bool blank_lines = false;     // returns blank lines, too
  };
  TextLines(std::string_view text, Rules rules) : rest_(skipByteOrderMark(text)), rules_(rules) {}
  explicit TextLines(std::string_view text) : TextLines(text, Rules()) {}
  // Takes the next line; false at the end of the text. Valid until the next call.
  bool next(std::string_view& line);
  // Number of the line that next() returned, from 1; for a continued line, that of its first part.
  int number() const { return number_; }

 private:
  bool takeWhole(std::string_view& line);

  std::string_view rest_;
  Rules rules_;
  int number_ = 0, following_ = 1;
  std::string joined_;
};

// Parses hand-written JSON. Skips a byte order mark. Error `id`, beginning with `path` and the line: invalid JSON (a
// decimal comma and NaN are named as such), or nesting deeper than 64, since JSON writers recurse as deep.
Result<nlohmann::json> parseJsonText(std::string_view text, const std::string& path, ErrorId id);

// Value of `key`; null if missing or if `node` is no object.
const nlohmann::json& jsonMember(const nlohmann::json& node, const char* key);
// Reads a list of exactly `count` finite numbers of at most `max` in size; false for anything else.
bool jsonNumbers(const nlohmann::json& node, size_t count, double* out,
                 double max = std::numeric_limits<double>::max());
// Value of a string, or else `otherwise`.
std::string jsonText(const nlohmann::json& node, const std::string& otherwise = {});

// Returns true for well-formed UTF-8, which JSON can hold.
bool isUtf8(std::string_view text);

}  // namespace fourdvt::capture

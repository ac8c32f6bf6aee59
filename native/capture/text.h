// SPDX-License-Identifier: Apache-2.0
// Line and number scanning for the capture's text files, independent of the locale.
#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>

namespace fourdvt::capture {

// Whole file as text; nullopt if it cannot be opened or read.
std::optional<std::string> readText(const std::string& path);

// A text without the byte order mark (UTF-8) that some editors put before it.
inline std::string_view skipByteOrderMark(std::string_view text) {
  return text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text;
}

// Takes the next line off `text` (without its end); false at the end.
inline bool takeLine(std::string_view& text, std::string_view& line) {
  if (text.empty()) return false;
  const size_t end = text.find('\n');
  line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
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

// The whole word as a number ("nan" and "inf" count as numbers), else nullopt.
template <class T>
std::optional<T> toNumber(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace fourdvt::capture

// SPDX-License-Identifier: Apache-2.0
#include "capture/text.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

namespace fourdvt::capture {
namespace {

constexpr size_t kMaxQuoted = 40;  // bytes of a quoted word in a message

std::string quoted(std::string_view word) {
  std::string out = "\"";
  for (const char c : word.substr(0, kMaxQuoted)) out += static_cast<unsigned char>(c) < ' ' ? '?' : c;
  return out + (word.size() > kMaxQuoted ? "...\"" : "\"");
}

// Ends the line before a comment that follows a blank.
std::string_view withoutComment(std::string_view line, char comment) {
  for (size_t at = line.find(comment); at != std::string_view::npos; at = line.find(comment, at + 1))
    if (at > 0 && (line[at - 1] == ' ' || line[at - 1] == '\t')) return line.substr(0, at);
  return line;
}

}  // namespace

std::optional<std::string> readText(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return std::nullopt;
  const std::streamoff size = file.tellg();
  std::error_code ignored;
  if (size < 0 || !std::filesystem::is_regular_file(path, ignored)) return std::nullopt;
  std::string text(static_cast<size_t>(size), '\0');
  file.seekg(0);
  if (!file.read(text.data(), size)) return std::nullopt;
  return text;
}

std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string lowerExtension(const std::string& path) {
  return lowerCase(std::filesystem::path(path).extension().string());
}

std::string_view trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

bool hasDecimalComma(std::string_view word) {
  const size_t comma = word.find(',');
  if (comma == std::string_view::npos || word.find(',', comma + 1) != std::string_view::npos) return false;
  if (comma + 1 == word.size() || (comma == 0 && word.size() == 1)) return false;
  std::string point(word);
  point[comma] = '.';
  return toNumber<double>(point).has_value();
}

std::string numberProblem(std::string_view word) {
  if (word.empty()) return "a number is missing";
  if (hasDecimalComma(word)) {
    std::string point(word);
    std::replace(point.begin(), point.end(), ',', '.');
    return quoted(word) + " has a decimal comma (write " + point + ", not " + std::string(word) + ")";
  }
  const auto value = toNumber<double>(word);
  if (!value) return quoted(word) + " is no number";
  return quoted(word) + (std::isfinite(*value) ? " is no whole number" : " is no finite number");
}

std::string tooManyNumbers(size_t count, size_t wanted) {
  return count > wanted ? " (it has " + std::to_string(count) + "; if they have decimal commas, write 1.5, not 1,5)"
                        : "";
}

int lineOfByte(std::string_view text, size_t byte) {
  std::string_view rest = text, line;
  int number = 0;
  while (text.size() - rest.size() <= byte && takeLine(rest, line)) ++number;
  return std::max(number, 1);
}

std::string atLine(const std::string& path, int number) { return path + ":" + std::to_string(number) + ": "; }

bool TextLines::takeWhole(std::string_view& line) {
  if (!takeLine(rest_, line)) return false;
  number_ = following_++;
  const size_t begin = line.find_first_not_of(" \t");
  const bool comment = rules_.comment && begin != std::string_view::npos && line[begin] == rules_.comment;
  if (!rules_.continued || comment || !line.ends_with('\\')) return true;
  joined_.clear();
  while (line.ends_with('\\')) {
    joined_.append(line.substr(0, line.size() - 1)) += ' ';
    if (!takeLine(rest_, line)) {
      line = {};
      break;
    }
    ++following_;
  }
  line = joined_.append(line);
  return true;
}

bool TextLines::next(std::string_view& line) {
  while (takeWhole(line)) {
    if (rules_.comment && rules_.comment_behind) line = withoutComment(line, rules_.comment);
    const size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos && !rules_.blank_lines) continue;
    if (begin != std::string_view::npos && rules_.comment && line[begin] == rules_.comment) continue;
    return true;
  }
  return false;
}

}  // namespace fourdvt::capture

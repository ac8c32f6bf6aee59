// SPDX-License-Identifier: Apache-2.0
#include "base/text.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <string_view>

namespace fourdvt {
std::string printed(const char* format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  std::string out(size_t(std::vsnprintf(nullptr, 0, format, arguments)), '\0');
  std::vsnprintf(out.data(), out.size() + 1, format, again);
  va_end(arguments);
  va_end(again);
  return out;
}

std::string hexDigits(uint64_t value) { return printed("%016llx", static_cast<unsigned long long>(value)); }
std::string frameName(uint32_t frame) { return printed("%06u", frame); }

std::string htmlEscaped(const std::string& text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else
      out += c;
  }
  return out;
}

namespace {

struct Line {
  std::string subjects, rest;
  std::vector<std::string> whole;  // subjects in full
};

// Splits a warning into subject and rest; without a subject, the rest is the whole text.
Line split(const std::string& warning) {
  const size_t end = warning.find(": ");
  if (end == std::string::npos) return {"", warning, {}};
  const std::string subject = warning.substr(0, end);
  return {subject, warning.substr(end), {subject}};
}

std::string unlike(const std::string& subject, const std::string& before) {
  const auto common =
      size_t(std::mismatch(subject.begin(), subject.end(), before.begin(), before.end()).first - subject.begin());
  const size_t at = common == 0 ? std::string::npos : subject.find_last_of("/ ", common - 1);
  return at == std::string::npos ? subject : subject.substr(at + 1);
}

}  // namespace

std::vector<std::string> joinedWarnings(const std::vector<std::string>& warnings) {
  std::vector<Line> lines;
  for (const std::string& warning : warnings) {
    const Line line = split(warning);
    const auto same = std::find_if(lines.begin(), lines.end(), [&](const Line& other) {
      return !line.subjects.empty() && !other.subjects.empty() && other.rest == line.rest;
    });
    if (same == lines.end()) {
      lines.push_back(line);
    } else if (std::count(same->whole.begin(), same->whole.end(), line.whole[0]) == 0) {
      if (same->subjects.starts_with("camera ")) same->subjects.insert(std::string_view("camera").size(), "s");
      same->subjects += ", " + unlike(line.whole[0], same->whole.back());
      same->whole.push_back(line.whole[0]);
    }
  }
  std::vector<std::string> out;
  for (const Line& line : lines) out.push_back(line.subjects + line.rest);
  return out;
}

}  // namespace fourdvt

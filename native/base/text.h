// SPDX-License-Identifier: Apache-2.0
// Text for messages, files and pages.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace fourdvt {
// Formats as std::printf does.
[[gnu::format(printf, 1, 2)]] std::string printed(const char* format, ...);

std::string hexDigits(uint64_t value);  // 16 digits; for names and texts
std::string frameName(uint32_t frame);  // six digits or more: "000012"

// Escapes text for HTML and SVG, also inside quoted attributes.
std::string htmlEscaped(const std::string& text);

// Joins the items, mapped by `text` (a function or a member).
template <class Items, class Text = std::identity>
std::string joined(const Items& items, const char* between = ", ", Text text = {}) {
  std::string out;
  bool is_first = true;
  for (const auto& item : items) {
    if (!is_first) out += between;
    out += std::invoke(text, item);
    is_first = false;
  }
  return out;
}

// Warnings and notes, one line each: "SUBJECT: what is wrong; what to do".

// Merges warnings that differ only in their subject into one line at the place of the first: "SUBJECT, SUBJECT: …",
// each subject once. A subject's common prefix with the one before, up to its last "/" or blank, is omitted:
// "walk/cam00.mp4, cam01.mp4".
std::vector<std::string> joinedWarnings(const std::vector<std::string>& warnings);

}  // namespace fourdvt

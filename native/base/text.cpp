// SPDX-License-Identifier: Apache-2.0
#include "base/text.h"

#include <cstdarg>
#include <cstdio>

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

}  // namespace fourdvt

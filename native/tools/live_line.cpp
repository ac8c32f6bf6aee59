// SPDX-License-Identifier: Apache-2.0
#include "tools/live_line.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

#include "tools/args.h"
#include "tools/log.h"

namespace fourdvt::tools {
namespace {

// A line that wraps cannot be rewritten.
std::string fitted(const std::string& line) {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col < 20 || line.size() < size.ws_col) return line;
  return line.substr(0, size.ws_col - 1u);
}

// Without control characters, which a peer may have sent.
std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

}  // namespace

LiveLine::LiveLine() : tty_(isatty(STDOUT_FILENO) != 0) {}

void LiveLine::show(const std::string& line) {
  if (logLevel() == LogLevel::Quiet) return;
  const std::lock_guard lock(mutex_);
  line_ = tty_ ? fitted(line) : line;
  std::printf(tty_ ? "\r\033[K%s" : "%s\n", line_.c_str());
  std::fflush(stdout);
}

void LiveLine::note(const std::string& line) {
  const std::lock_guard lock(mutex_);
  if (tty_ && !line_.empty()) {
    std::fputs("\r\033[K", stdout);
    std::fflush(stdout);
  }
  std::fprintf(stderr, "%s: %s\n", programName(), printable(line).c_str());
  if (!tty_ || line_.empty()) return;
  std::fputs(line_.c_str(), stdout);
  std::fflush(stdout);
}

void LiveLine::end() {
  const std::lock_guard lock(mutex_);
  if (tty_ && !line_.empty()) std::fputs("\n", stdout);
  line_.clear();
}

}  // namespace fourdvt::tools

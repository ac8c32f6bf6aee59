// SPDX-License-Identifier: Apache-2.0
#include "tools/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cctype>
#include <csignal>
#include <cstdarg>
#include <cstdio>

#include "base/text.h"
#include "tools/args.h"

namespace fourdvt::tools {
namespace {

LogLevel log_level = LogLevel::Normal;

void printLine(std::FILE* out, const char* what, const char* format, va_list values) {
  if (what) std::fprintf(out, "%s: %s", programName(), what);
  std::vfprintf(out, format, values);
  std::fputc('\n', out);
  std::fflush(out);
}

}  // namespace

LogLevel logLevel() { return log_level; }
void setLogLevel(LogLevel level) { log_level = level; }

void warn(const char* format, ...) {
  va_list values;
  va_start(values, format);
  printLine(stderr, "warning: ", format, values);
  va_end(values);
}

void note(const char* format, ...) {
  if (log_level == LogLevel::Quiet) return;
  va_list values;
  va_start(values, format);
  printLine(stdout, nullptr, format, values);
  va_end(values);
}

void detail(const char* format, ...) {
  if (log_level != LogLevel::Verbose) return;
  va_list values;
  va_start(values, format);
  printLine(stderr, "", format, values);
  va_end(values);
}

bool rewritesProgress() { return log_level != LogLevel::Quiet && isatty(STDERR_FILENO) != 0; }

namespace {

std::string timeLeft(double seconds) {
  const int s = static_cast<int>(seconds + 0.5);
  return s < 60 ? printed("%d s", s) : printed("%d min %02d s", s / 60, s % 60);
}

// "survey walk 12/28" → "survey walk", "outline 25 %" → "outline"
std::string withoutCount(std::string stage) {
  for (size_t space; (space = stage.find_last_of(' ')) != std::string::npos; stage.resize(space)) {
    const unsigned char first = static_cast<unsigned char>(stage[space + 1]);
    if (!std::isdigit(first) && first != '%') break;
  }
  return stage;
}

}  // namespace

ProgressLine::ProgressLine() : tty_(isatty(STDERR_FILENO) != 0) {}

void ProgressLine::timeStage(const std::string& stage) {
  if (stage == stage_ || logLevel() != LogLevel::Verbose) return;
  const auto now = std::chrono::steady_clock::now();
  if (!stage_.empty() && tty_ && shown_) std::fputs("\r\033[K", stderr);
  if (!stage_.empty()) detail("%s: %.1f s", stage_.c_str(), std::chrono::duration<double>(now - began_).count());
  stage_ = stage;
  began_ = now;
}

void ProgressLine::show(const FrameProgress& p) {
  if (logLevel() == LogLevel::Quiet) return;
  timeStage(withoutCount(p.stage));
  const auto now = std::chrono::steady_clock::now();
  const bool all_frames = p.done == p.total && !all_frames_;
  const auto pause = tty_ ? std::chrono::milliseconds(100) : std::chrono::seconds(5);
  if (!all_frames && shown_ && now - last_ < pause) return;
  if (!tty_ && line_ == p.stage) return;
  last_ = now;
  shown_ = true;
  all_frames_ |= all_frames;
  line_ = p.stage;
  std::string line = p.stage;
  if (p.total > 0) line += printed("  %u of %u frames", p.done, p.total);
  if (p.frames_per_s > 0) line += printed("  %.2f frames/s", p.frames_per_s);
  if (p.left_s > 0) line += "  " + timeLeft(p.left_s) + " left";
  std::fprintf(stderr, tty_ ? "\r\033[K%s" : "%s\n", line.c_str());
  std::fflush(stderr);
}

void ProgressLine::end() {
  timeStage("");
  if (tty_ && shown_) std::fputs("\r\033[K", stderr);
  shown_ = false;
}

namespace {

// Truncates a line to the terminal's width: a wrapped line cannot be rewritten.
std::string fitted(const std::string& line) {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col < 20 || line.size() < size.ws_col) return line;
  return line.substr(0, size.ws_col - 1u);
}

// Removes control characters, which a peer may have sent.
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

namespace {

std::atomic<bool> g_stop{false};

void onSignal(int) {
  if (g_stop.exchange(true)) _exit(kInterrupted);
}

}  // namespace

const std::atomic<bool>* listenForStop() {
  struct sigaction action {};
  action.sa_handler = onSignal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  return &g_stop;
}

}  // namespace fourdvt::tools

// SPDX-License-Identifier: Apache-2.0
#include "tools/progress_line.h"

#include <unistd.h>

#include <cctype>
#include <cstdio>

#include "base/text.h"
#include "tools/log.h"

namespace fourdvt::tools {
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

}  // namespace fourdvt::tools

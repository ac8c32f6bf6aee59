// SPDX-License-Identifier: Apache-2.0
#include "tools/progress_line.h"

#include <unistd.h>

#include <cstdio>

namespace fourdvt::tools {
namespace {

std::string timeLeft(double seconds) {
  char text[32];
  const int s = static_cast<int>(seconds + 0.5);
  if (s < 60)
    std::snprintf(text, sizeof text, "%d s", s);
  else
    std::snprintf(text, sizeof text, "%d min %02d s", s / 60, s % 60);
  return text;
}

}  // namespace

ProgressLine::ProgressLine() : tty_(isatty(STDERR_FILENO) != 0) {}

void ProgressLine::show(const FrameProgress& p) {
  const auto now = std::chrono::steady_clock::now();
  const bool all_frames = p.done == p.total && !all_frames_;
  const auto pause = tty_ ? std::chrono::milliseconds(100) : std::chrono::seconds(5);
  if (!all_frames && shown_ && now - last_ < pause) return;
  if (!tty_ && line_ == p.stage) return;
  last_ = now;
  shown_ = true;
  all_frames_ |= all_frames;
  line_ = p.stage;
  char numbers[120] = "";
  if (p.total > 0) std::snprintf(numbers, sizeof numbers, "  %u of %u frames", p.done, p.total);
  std::string line = p.stage + numbers;
  if (p.frames_per_s > 0) {
    std::snprintf(numbers, sizeof numbers, "  %.2f frames/s", p.frames_per_s);
    line += numbers;
  }
  if (p.left_s > 0) line += "  " + timeLeft(p.left_s) + " left";
  std::fprintf(stderr, tty_ ? "\r\033[K%s" : "%s\n", line.c_str());
  std::fflush(stderr);
}

void ProgressLine::end() {
  if (tty_ && shown_) std::fputs("\r\033[K", stderr);
}

}  // namespace fourdvt::tools

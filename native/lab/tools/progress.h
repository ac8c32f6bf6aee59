// SPDX-License-Identifier: Apache-2.0
// Progress of the lab's commands on stderr.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <optional>
#include <string>

#include "base/text.h"
#include "lab/study/run/context.h"

namespace fourdvt::lab {

// Prints one line, rewritten in place, on a terminal; elsewhere a line every 5 s.
class StudyLine {
 public:
  ~StudyLine() { end(); }
  void show(const study::StudyProgress& p) {
    const auto now = Clock::now();
    if (!started_) started_ = now, first_share_ = p.share;
    if (shown_ && now - last_ < (tty_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(5000))) return;
    last_ = now;
    shown_ = true;
    const std::string numbers = printed("%3.0f %%  ", 100 * p.share);
    const std::string line = numbers + p.step + (p.detail.empty() ? "" : ": " + p.detail) + timeLeft(now, p.share);
    std::fprintf(stderr, tty_ ? "\r\033[K%s" : "%s\n", line.c_str());
    std::fflush(stderr);
  }
  void end() const {
    if (tty_ && shown_) std::fputs("\r\033[K", stderr);
  }

 private:
  using Clock = std::chrono::steady_clock;
  // Estimates the remaining time; excludes work of earlier runs.
  std::string timeLeft(Clock::time_point now, double share) const {
    const double elapsed_s = std::chrono::duration<double>(now - *started_).count(), done = share - first_share_;
    if (elapsed_s < 3 || done < 0.01) return "";
    const int left_s = static_cast<int>(elapsed_s * (1 - share) / done + 0.5);
    return left_s < 60 ? printed("  %d s left", left_s) : printed("  %d min %02d s left", left_s / 60, left_s % 60);
  }
  const bool tty_ = isatty(STDERR_FILENO) != 0;
  bool shown_ = false;
  std::optional<Clock::time_point> started_;
  double first_share_ = 0;
  Clock::time_point last_;
};

// Progress line, rewritten in place on a terminal.
class FrameLine {
 public:
  ~FrameLine() { end(); }
  void operator()(const std::string& sequence, uint32_t frame) const {
    if (tty_) std::fprintf(stderr, "\r\033[K%s frame %u", sequence.c_str(), frame);
  }
  void end() const {
    if (tty_) std::fputs("\r\033[K", stderr);
  }

 private:
  const bool tty_ = isatty(STDERR_FILENO) != 0;
};

}  // namespace fourdvt::lab

// SPDX-License-Identifier: Apache-2.0
// The progress of a command that works through frames, on standard error: on a terminal one line, rewritten in place;
// elsewhere a line every 5 s, and one when all frames are done. None with --quiet; with --verbose also the seconds that
// each stage took.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace fourdvt::tools {

struct FrameProgress {
  std::string stage;
  uint32_t done = 0, total = 0;         // frames; total 0: not known yet
  double frames_per_s = 0, left_s = 0;  // 0: not known
};

class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine() { end(); }
  void show(const FrameProgress& progress);
  void end();

 private:
  void timeStage(const std::string& stage);  // that begins; empty: none

  const bool tty_;
  std::string stage_;
  std::chrono::steady_clock::time_point began_;
  bool shown_ = false, all_frames_ = false;
  std::string line_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace fourdvt::tools

// SPDX-License-Identifier: Apache-2.0
// Output of running commands by log level, and Ctrl-C. Errors (args.h) and requested results have no level and are
// always printed.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>

#include "base/watch.h"

namespace fourdvt::tools {

enum class LogLevel { Quiet, Normal, Verbose };
LogLevel logLevel();
void setLogLevel(LogLevel level);  // called by Args for --quiet and --verbose

// Prints "PROGRAM: warning: …" on stderr, at all levels: the result may be unintended.
void warn(const char* format, ...) __attribute__((format(printf, 1, 2)));
// Prints a result and its place as a line on stdout, unless --quiet.
void note(const char* format, ...) __attribute__((format(printf, 1, 2)));
// Prints options, times and files as "PROGRAM: …" on stderr, with --verbose only.
void detail(const char* format, ...) __attribute__((format(printf, 1, 2)));
// Returns true if progress may rewrite its line: stderr is a terminal, without --quiet.
bool rewritesProgress();

// Progress of a command that works through frames, on standard error: on a terminal one line, rewritten in place;
// elsewhere a line every 5 s, and one when all frames are done. None with --quiet; with --verbose also the seconds of
// each stage.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine() { end(); }
  void show(const FrameProgress& progress);
  void end();

 private:
  void timeStage(const std::string& stage);  // stage that begins; empty: none

  const bool tty_;
  std::string stage_;
  std::chrono::steady_clock::time_point began_;
  bool shown_ = false, all_frames_ = false;
  std::string line_;
  std::chrono::steady_clock::time_point last_;
};

// Display of a command that runs until it is stopped: one line, rewritten in place on a terminal and printed anew
// elsewhere, and permanent notes. Thread-safe.
class LiveLine {
 public:
  LiveLine();
  void show(const std::string& line);  // standard output
  void note(const std::string& line);  // standard error, after the program's name
  void end();

 private:
  const bool tty_;
  std::mutex mutex_;
  std::string line_;  // currently on the terminal
};

// Catches Ctrl-C and SIGTERM for commands that keep finished work: the first signal sets the flag; a second one ends
// the process at once with kInterrupted.
const std::atomic<bool>* listenForStop();

}  // namespace fourdvt::tools

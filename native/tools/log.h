// SPDX-License-Identifier: Apache-2.0
// What commands print besides errors (args.h) and results that were asked for, which they print at every level.
#pragma once

namespace fourdvt::tools {

enum class LogLevel { Quiet, Normal, Verbose };
LogLevel logLevel();
void setLogLevel(LogLevel level);  // Args does, by --quiet and --verbose

// What was done, but may not be what was meant: "PROGRAM: warning: …" on stderr, at every level.
void warn(const char* format, ...) __attribute__((format(printf, 1, 2)));
// What was done, and where it lies: a line on stdout, not with --quiet.
void note(const char* format, ...) __attribute__((format(printf, 1, 2)));
// Options, times, files: "PROGRAM: …" on stderr, with --verbose.
void detail(const char* format, ...) __attribute__((format(printf, 1, 2)));
// A line of progress may be rewritten in place on stderr.
bool rewritesProgress();

}  // namespace fourdvt::tools

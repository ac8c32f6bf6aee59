// SPDX-License-Identifier: Apache-2.0
// Prints notes of commands by level. Errors (args.h) and results that were asked for are printed at every level.
#pragma once

namespace fourdvt::tools {

enum class LogLevel { Quiet, Normal, Verbose };
LogLevel logLevel();
void setLogLevel(LogLevel level);  // Args does, by --quiet and --verbose

// Prints "PROGRAM: warning: …" on stderr, at every level: the result may not be the one that was meant.
void warn(const char* format, ...) __attribute__((format(printf, 1, 2)));
// Prints a result and its place as a line on stdout, not with --quiet.
void note(const char* format, ...) __attribute__((format(printf, 1, 2)));
// Options, times, files: "PROGRAM: …" on stderr, with --verbose.
void detail(const char* format, ...) __attribute__((format(printf, 1, 2)));
// A line of progress may be rewritten in place on stderr.
bool rewritesProgress();

}  // namespace fourdvt::tools

// SPDX-License-Identifier: Apache-2.0
// Prints notes of commands by level; errors (args.h) and requested results have no level and are always printed.
#pragma once

namespace fourdvt::tools {

enum class LogLevel { Quiet, Normal, Verbose };
LogLevel logLevel();
void setLogLevel(LogLevel level);  // Args does, by --quiet and --verbose

// Prints "PROGRAM: warning: …" on stderr, at every level: the result may not be the one that was meant.
void warn(const char* format, ...) __attribute__((format(printf, 1, 2)));
// Prints a result and its place as a line on stdout, not with --quiet.
void note(const char* format, ...) __attribute__((format(printf, 1, 2)));
// Prints options, times and files as "PROGRAM: …" on stderr, with --verbose only.
void detail(const char* format, ...) __attribute__((format(printf, 1, 2)));
// True if progress may rewrite its line: stderr is a terminal, and not with --quiet.
bool rewritesProgress();

}  // namespace fourdvt::tools

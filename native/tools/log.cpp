// SPDX-License-Identifier: Apache-2.0
#include "tools/log.h"

#include <unistd.h>

#include <cstdarg>
#include <cstdio>

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

}  // namespace fourdvt::tools

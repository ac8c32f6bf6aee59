// SPDX-License-Identifier: Apache-2.0
#include "tools/program.h"

#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#include "base/watch.h"
#include "tools/args.h"
#include "tools/log.h"

namespace fourdvt::tools {
namespace {

void printUsage(std::FILE* out, std::span<const Command> commands) {
  std::fprintf(out, "usage: %s COMMAND …   (%s COMMAND --help)\n\n", programName(), programName());
  for (const Command& command : commands) std::fprintf(out, "  %-12s %s\n", command.name, command.summary);
  std::fputs("\nEvery command has --quiet and --verbose.\n", out);
}

// Libraries throw where memory runs out, or on input that nothing before them refused.
int runGuarded(const Command& command, int argc, char** argv) {
  try {
    const Watch watch;
    const int code = command.run(argc - 2, argv + 2);
    detail("%s: %.1f s in all", command.name, watch.seconds());
    return code;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "%s: %s: out of memory; reduce the detail or --jobs\n", programName(), command.name);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: %s: unexpected: %s\n", programName(), command.name, e.what());
  }
  return kFailed;
}

}  // namespace

int runProgram(const char* program, std::span<const Command> commands, int argc, char** argv) {
  setProgramName(program);
  const char* name = argc > 1 ? argv[1] : "";
  for (const Command& command : commands)
    if (std::strcmp(name, command.name) == 0) return runGuarded(command, argc, argv);
  if (std::strcmp(name, "--help") == 0 || std::strcmp(name, "-h") == 0) {
    printUsage(stdout, commands);
    return kOk;
  }
  if (std::strcmp(name, "--version") == 0) {
    std::printf("%s %s\n", programName(), FOURDVT_VERSION);
    return kOk;
  }
  if (*name) std::fprintf(stderr, "%s: unknown command \"%s\"\n", programName(), name);
  printUsage(stderr, commands);
  return kUsage;
}

}  // namespace fourdvt::tools

// SPDX-License-Identifier: Apache-2.0
#include "tools/commands.h"

#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#include "base/watch.h"
#include "tools/args.h"
#include "tools/terminal.h"

namespace fourdvt::tools {
namespace {

void printUsage(std::FILE* out, std::span<const Command> commands) {
  std::fprintf(out, "usage: %s COMMAND …   (%s COMMAND --help)\n\n", programName(), programName());
  for (const Command& command : commands) std::fprintf(out, "  %-12s %s\n", command.name, command.summary);
  std::fputs("\nEvery command has --quiet and --verbose.\n", out);
}

// Prints that the command is missing in this build: a staged build makes a first page's commands first.
int printNotBuiltYet(const Command& command) {
  std::fprintf(stderr,
               "%s: \"%s\" is not built yet. site/demo.sh builds it once the page is served, in some minutes "
               "(build/rest.log); site/demo.sh --prepare builds everything at once\n",
               programName(), command.name);
  return kFailed;
}

// Catches exceptions of libraries, thrown if memory runs out or on input that passed all checks.
int runGuarded(const Command& command, int argc, char** argv) {
  try {
    const Watch watch;
    const Result<int> result = command.run(argc - 2, argv + 2);
    const int code = result.ok() ? result.value() : fail(result.error());
    const double seconds = watch.seconds();
    detail("%s: %.1f s in all", command.name, seconds);
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
    if (std::strcmp(name, command.name) == 0)
      return command.run ? runGuarded(command, argc, argv) : printNotBuiltYet(command);
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

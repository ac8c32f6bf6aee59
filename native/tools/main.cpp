// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#include "tools/args.h"
#include "tools/commands.h"

namespace {

struct Command {
  const char* name;
  const char* summary;
  int (*run)(int argc, char** argv);
};

constexpr Command kCommands[] = {
    {"reconstruct", "make surfaces for a capture that has cameras alone", fourdvt::tools::reconstructCommand},
    {"bake", "turn a capture folder into a character folder", fourdvt::tools::bakeCommand},
    {"inspect", "list what is inside a character and check every byte of it", fourdvt::tools::inspectCommand},
    {"render", "draw one frame, or a turntable movie, of a character", fourdvt::tools::renderCommand},
    {"studio", "render a model, or a built-in actor, as a capture folder", fourdvt::tools::studioCommand},
    {"evaluate", "measure a character against its capture's pictures", fourdvt::tools::evaluateCommand},
};

void printUsage(std::FILE* out) {
  std::fputs("usage: fourdvt COMMAND …   (fourdvt COMMAND --help)\n\n", out);
  for (const Command& command : kCommands) std::fprintf(out, "  %-12s %s\n", command.name, command.summary);
}

// Libraries throw where memory runs out, or on input that nothing before them refused.
int runGuarded(const Command& command, int argc, char** argv) {
  try {
    return command.run(argc - 2, argv + 2);
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "fourdvt: %s: out of memory; ask for less detail, or fewer --jobs\n", command.name);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "fourdvt: %s: unexpected: %s\n", command.name, e.what());
  }
  return fourdvt::tools::kFailed;
}

}  // namespace

int main(int argc, char** argv) {
  const char* name = argc > 1 ? argv[1] : "";
  for (const Command& command : kCommands)
    if (std::strcmp(name, command.name) == 0) return runGuarded(command, argc, argv);
  if (std::strcmp(name, "--help") == 0 || std::strcmp(name, "-h") == 0) {
    printUsage(stdout);
    return fourdvt::tools::kOk;
  }
  if (std::strcmp(name, "--version") == 0) {
    std::puts("fourdvt " FOURDVT_VERSION);
    return fourdvt::tools::kOk;
  }
  if (*name) std::fprintf(stderr, "fourdvt: unknown command \"%s\"\n", name);
  printUsage(stderr);
  return fourdvt::tools::kUsage;
}

// SPDX-License-Identifier: Apache-2.0
// A program made of subcommands: help and version.
#pragma once

#include <span>

#include "base/result.h"

namespace fourdvt::tools {

struct Command {
  const char* name;
  const char* summary;
  // Takes the arguments after the command's name and returns the exit code (args.h); null: not in this build.
  Result<int> (*run)(int argc, char** argv);
};

// Runs the command that argv[1] names. Exceptions of libraries end in a message and kFailed.
int runProgram(const char* program, std::span<const Command> commands, int argc, char** argv);

}  // namespace fourdvt::tools

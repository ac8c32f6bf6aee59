// SPDX-License-Identifier: Apache-2.0
// A program made of subcommands: help and version.
#pragma once

#include <span>
#include <string>

namespace fourdvt::tools {

struct Command {
  const char* name;
  const char* summary;
  int (*run)(int argc, char** argv);  // arguments after the command's name; returns the exit code (args.h)
};

// Runs the command that argv[1] names. Exceptions of libraries end in a message and kFailed.
int runProgram(const char* program, std::span<const Command> commands, int argc, char** argv);

}  // namespace fourdvt::tools

// SPDX-License-Identifier: Apache-2.0
// A program made of subcommands: help, version, and the way from a command's former name to its present one.
#pragma once

#include <span>
#include <string>

namespace fourdvt::tools {

struct Command {
  const char* name;
  const char* summary;
  int (*run)(int argc, char** argv);  // arguments after the command's name; returns the exit code (args.h)
};

// A command that has moved to another name.
struct FormerCommand {
  const char* name;
  std::string (*present)(int argc, char** argv);  // the command line to use for these arguments
};

// Runs the command that argv[1] names. Exceptions of libraries end in a message and kFailed.
int runProgram(const char* program, std::span<const Command> commands, std::span<const FormerCommand> former, int argc,
               char** argv);

}  // namespace fourdvt::tools

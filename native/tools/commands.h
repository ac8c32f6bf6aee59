// SPDX-License-Identifier: Apache-2.0
// A program made of subcommands, with help and version; and the subcommands of `fourdvt`. Each parses, checks, calls
// the library and returns the exit code (args.h).
#pragma once

#include <span>

#include "base/result.h"
#include "tools/args.h"

namespace fourdvt::bake {
struct BakeOptions;
}

namespace fourdvt::tools {

struct Command {
  const char* name;
  const char* summary;
  // Takes the arguments after the command's name and returns the exit code; null: not in this build.
  Result<int> (*run)(int argc, char** argv);
};

// Runs the command named by argv[1]. Exceptions of libraries end in a message and kFailed.
int runProgram(const char* program, std::span<const Command> commands, int argc, char** argv);

// Additional `bake` options of another program.
using BakeExtension = Options (*)(bake::BakeOptions&);

Result<int> importCommand(int argc, char** argv);
Result<int> calibrateCommand(int argc, char** argv);
Result<int> mattesCommand(int argc, char** argv);
Result<int> reconstructCommand(int argc, char** argv);
Result<int> bakeCommand(int argc, char** argv, BakeExtension extension = nullptr);
Result<int> planCommand(int argc, char** argv);
Result<int> pieceCommand(int argc, char** argv);
Result<int> finishCommand(int argc, char** argv);
Result<int> jobCommand(int argc, char** argv);
Result<int> inspectCommand(int argc, char** argv);
Result<int> renderCommand(int argc, char** argv);
Result<int> liveCommand(int argc, char** argv);
Result<int> liveCameraCommand(int argc, char** argv);

}  // namespace fourdvt::tools

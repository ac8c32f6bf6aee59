// SPDX-License-Identifier: Apache-2.0
// The subcommands of `fourdvt`; each parses, checks, calls the library and returns the exit code (args.h).
#pragma once

#include "tools/args.h"

namespace fourdvt::bake {
struct BakeOptions;
}

namespace fourdvt::tools {

// Options that another program adds to `bake`.
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

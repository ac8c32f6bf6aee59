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

int importCommand(int argc, char** argv);
int calibrateCommand(int argc, char** argv);
int mattesCommand(int argc, char** argv);
int reconstructCommand(int argc, char** argv);
int bakeCommand(int argc, char** argv, BakeExtension extension = nullptr);
int planCommand(int argc, char** argv);
int pieceCommand(int argc, char** argv);
int finishCommand(int argc, char** argv);
int jobCommand(int argc, char** argv);
int inspectCommand(int argc, char** argv);
int renderCommand(int argc, char** argv);
int liveCommand(int argc, char** argv);
int liveCameraCommand(int argc, char** argv);

}  // namespace fourdvt::tools

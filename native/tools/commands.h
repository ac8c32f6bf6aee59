// SPDX-License-Identifier: Apache-2.0
// The subcommands of `fourdvt`; each parses, checks, calls the library and returns the exit code (args.h).
#pragma once

namespace fourdvt::tools {

int reconstructCommand(int argc, char** argv);
int bakeCommand(int argc, char** argv);
int inspectCommand(int argc, char** argv);
int renderCommand(int argc, char** argv);
int studioCommand(int argc, char** argv);
int evaluateCommand(int argc, char** argv);

}  // namespace fourdvt::tools

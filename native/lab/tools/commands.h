// SPDX-License-Identifier: Apache-2.0
// The subcommands of `fourdvt-lab`; each parses, checks, calls the library and returns the exit code (tools/args.h).
#pragma once

#include "base/result.h"

namespace fourdvt::lab {

Result<int> stageCommand(int argc, char** argv);
Result<int> streamCommand(int argc, char** argv);
Result<int> studioCommand(int argc, char** argv);
Result<int> trackCommand(int argc, char** argv);
Result<int> bakeCommand(int argc, char** argv);
Result<int> studyCommand(int argc, char** argv);
Result<int> scoreCommand(int argc, char** argv);
Result<int> methodsCommand(int argc, char** argv);
Result<int> mattesCommand(int argc, char** argv);
Result<int> surfacesCommand(int argc, char** argv);
Result<int> driftCommand(int argc, char** argv);

}  // namespace fourdvt::lab

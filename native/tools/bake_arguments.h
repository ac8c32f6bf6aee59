// SPDX-License-Identifier: Apache-2.0
// The command line of `fourdvt bake`, which `fourdvt plan bake` takes too.
#pragma once

#include <optional>
#include <string>

#include "bake/bake.h"
#include "tools/commands.h"
#include "tools/progress_line.h"
#include "tools/session.h"

namespace fourdvt::tools {

// Sets the options; with a value, help or a problem was printed, and that is the exit code.
Result<std::optional<int>> readBakeCommand(int argc, char** argv, bake::BakeOptions& options,
                                           BakeExtension extension = nullptr);
// Borrows both; Ctrl-C is listened for.
bake::BakeEnvironment bakeEnvironment(const GpuSession& gpu, ProgressLine& line);
void printBakeSummary(const std::string& character_folder, const bake::BakeReport& report, double seconds);

}  // namespace fourdvt::tools

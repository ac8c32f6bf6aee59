// SPDX-License-Identifier: Apache-2.0
// The command line of `fourdvt reconstruct`, which `fourdvt plan reconstruct` takes too.
#pragma once

#include <optional>
#include <string>

#include "reconstruct/run/reconstruct.h"
#include "tools/progress_line.h"
#include "tools/session.h"

namespace fourdvt::tools {

// Sets the options; with a value, help or a problem was printed, and that is the exit code.
std::optional<int> readReconstructCommand(int argc, char** argv, reconstruct::ReconstructOptions& options);
// Borrows both; Ctrl-C is listened for. A session without a device will do where stereo is off.
reconstruct::ReconstructEnvironment reconstructEnvironment(const GpuSession& gpu, ProgressLine& line);
void printReconstructSummary(const std::string& folder, const reconstruct::ReconstructSummary& summary);

}  // namespace fourdvt::tools

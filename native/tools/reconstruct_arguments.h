// SPDX-License-Identifier: Apache-2.0
// The command line of `fourdvt reconstruct`, which `fourdvt plan reconstruct` takes too.
#pragma once

#include <optional>
#include <string>

#include "reconstruct/run/reconstruct.h"
#include "tools/progress_line.h"
#include "tools/session.h"

namespace fourdvt::tools {

struct ReconstructCommandLine {
  reconstruct::ReconstructOptions options;
  std::optional<int> exit_code;  // help or a problem was printed; none: the options are valid
};

ReconstructCommandLine readReconstructCommand(int argc, char** argv);
// Borrows both; Ctrl-C is listened for. A session without a device will do where stereo is off.
reconstruct::ReconstructEnvironment reconstructEnvironment(const GpuSession& gpu, ProgressLine& line);
void printReconstructSummary(const std::string& folder, const reconstruct::ReconstructSummary& summary);

}  // namespace fourdvt::tools

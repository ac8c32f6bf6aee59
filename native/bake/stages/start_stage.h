// SPDX-License-Identifier: Apache-2.0
// The start file (package/start_file.h), cut out of the first sequence's finished files: nothing is encoded anew but
// one frame's geometry.
#pragma once

#include "bake/report/report.h"
#include "bake/run/bake_run.h"
#include "package/character.h"

namespace fourdvt::bake {

constexpr const char* kStartFile = "character.start.bin";

// Writes it into job.resultFolder(), beside the files of character.sequences[0], and names it in the manifest. Errors:
// WriteFailed, Internal.
Status writeStart(const BakeRun& run, package::Character& character, ReportInput& report);

}  // namespace fourdvt::bake

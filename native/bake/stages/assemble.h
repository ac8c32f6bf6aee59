// SPDX-License-Identifier: Apache-2.0
// Finished GOPs → the character folder, complete in a sibling folder first, renamed into place at the very end.
#pragma once

#include "bake/run/bake_run.h"
#include "bake/stages/report.h"

namespace fourdvt::bake {

// Writes every file into job.resultFolder() and completes `report` (sequences, codec, pictures, bytes by part); the
// report's own files come last, by writeReportFiles. graph: the motion graph's file; empty: none. Errors: WriteFailed,
// Internal, GpuFailure.
Status assemble(BakeRun& run, const std::vector<uint8_t>& graph, ReportInput& report);
// report.json and report.html into job.resultFolder().
Status writeReportFiles(const Job& job, const ReportInput& report);

}  // namespace fourdvt::bake

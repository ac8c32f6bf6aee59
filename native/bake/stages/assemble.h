// SPDX-License-Identifier: Apache-2.0
// Makes the character folder from finished GOPs: complete in a sibling folder first, which bake.cpp renames into place.
#pragma once

#include "bake/run/bake_run.h"
#include "bake/stages/report.h"

namespace fourdvt::bake {

// Writes every file but the report's into job.resultFolder() and completes `report` (sequences, codec, pictures, bytes
// by part). `graph`: bytes of the motion graph's file; empty if there is none. Errors: WriteFailed,
// Internal, GpuFailure.
Status assemble(BakeRun& run, const std::vector<uint8_t>& graph, ReportInput& report);
// Writes report.json and report.html into job.resultFolder().
Status writeReportFiles(const Job& job, const ReportInput& report);

}  // namespace fourdvt::bake

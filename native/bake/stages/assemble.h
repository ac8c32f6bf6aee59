// SPDX-License-Identifier: Apache-2.0
// Makes the character folder from finished GOPs: complete in a sibling folder first, which
// bake.cpp publishes.
#pragma once

#include "bake/report/report.h"
#include "bake/run/bake_run.h"
#include "bake/stages/room_stage.h"

namespace fourdvt::bake {

constexpr int kPosterWidth = 720, kPosterHeight = 960;

// Writes every file but the report's into job.resultFolder() and completes `report` (sequences, codec, pictures, bytes
// by part). `graph`: bytes of the motion graph's file; empty if there is none. Errors: WriteFailed,
// Internal, GpuFailure.
Status assemble(BakeRun& run, const std::vector<uint8_t>& graph, const std::optional<BakedRoom>& room,
                ReportInput& report);
// Writes the room's picture and names it in the manifest. No room: nothing.
Status writeRoom(const Job& job, const std::optional<BakedRoom>& room, package::Character& character,
                 ReportInput& report);
// Sets the report's renditions, once their files are written.
void describeRenditions(const package::Sequence& sequence, ReportSequence& report);
// What the report says of characters of either kind.
void describeCommon(const Job& job, const package::Character& character, ReportInput& report);
// Writes what the refinement found: views whose outlines were far off, and the cameras if one of them changed.
Status describeRefinement(const Job& job, ReportInput& report);
// Empty folders for the character and its report.
Status makeResultFolders(const Job& job);
// Writes report.json, report.html and the character's pictures that they show into job.reportFolder().
Status writeReportFiles(const Job& job, const ReportInput& report);

}  // namespace fourdvt::bake

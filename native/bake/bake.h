// SPDX-License-Identifier: Apache-2.0
// Bakes a capture folder into a character folder. bake/run/stage_table.h lists the stages in order of execution,
// bake/stages/ implements them. The pictures are read three times: the refinement aligns mesh and cameras with the
// pictures, in up to 40 frames; the survey measures visibility and colours, from which the labels of whole sequences
// follow; then every GOP is resampled, filled, tiled and encoded. A character from cameras has no survey and no labels:
// its GOPs contain crops of the pictures, and surfaces.
//
// Memory: one frame of pictures and one GOP of packets and meshes, whatever the length; while refining, the mattes
// and meshes of its frames (refine/frames.h); for classes also 12 bytes per vertex, phase and further member, for the
// alignment over the whole motion.
#pragma once

#include "bake/run/figures.h"
#include "bake/run/options.h"
#include "base/result.h"
#include "jobs/plan.h"

namespace fourdvt::bake {

Result<BakeReport> bake(const BakeOptions& options, const BakeEnvironment& environment);

// The same bake in pieces (pieces.h), which any process with the same files may compute, several at once. The job
// folder is the work folder, CHARACTER.work.
//
// Checks and plans the bake, and writes the plan into the job folder. `arguments`: the command line, recorded in the
// plan. Finished work in the folder is kept if capture and settings are the same.
Result<jobs::Plan> planBake(const BakeOptions& options, std::vector<std::string> arguments,
                            const BakeEnvironment& environment);
// Computes one piece of the folder's plan, which must come from this build; finished pieces are skipped. Errors:
// those of its stage, InvalidArgument (files that have changed, a job of another plan).
Status bakePiece(const std::string& job_folder, const jobs::Plan& plan, const jobs::Piece& piece, int threads,
                 const BakeEnvironment& environment);
// Writes the character and its report from finished pieces, and computes those that are missing. The job folder
// stays.
Result<BakeReport> finishBake(const std::string& job_folder, const jobs::Plan& plan,
                              const BakeEnvironment& environment);

}  // namespace fourdvt::bake

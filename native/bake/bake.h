// SPDX-License-Identifier: Apache-2.0
// Capture folder → character folder. bake/run/stage_table.h lists the stages in order of execution, bake/stages/ holds
// them. The bake looks at the pictures three times: the refinement makes mesh and cameras agree with them, in up to 40
// frames; the survey measures visibility and colours, from which the labels of whole sequences follow; then every GOP
// is resampled, filled, tiled and encoded. A character from cameras has no survey and no labels: its GOPs are crops of
// the pictures, and surfaces.
//
// Does NOT decide how frames are shown. Memory: one frame of pictures and one GOP of packets and meshes, whatever the
// length; while refining, the mattes and meshes of its frames (refine/frames.h); for classes also 12 bytes per vertex,
// phase and further member, for the alignment over the whole motion.
#pragma once

#include "bake/run/figures.h"
#include "bake/run/options.h"
#include "base/result.h"
#include "jobs/plan.h"

namespace fourdvt::bake {

Result<BakeReport> bake(const BakeOptions& options, const BakeEnvironment& environment);

// The same in pieces (pieces.h), which any process with the same files may compute, several at once. The job folder is
// the work folder, CHARACTER.work.
//
// Checks and plans everything, and writes the plan into the job folder. `arguments`: the command line, for readers of
// the plan. What the folder has of the same capture and settings stays.
Result<jobs::Plan> planBake(const BakeOptions& options, std::vector<std::string> arguments,
                            const BakeEnvironment& environment);
// Computes one piece of the folder's plan, which this build has made, or nothing where it is done. Errors: those of its
// stage, InvalidArgument (files that have changed, a job of another plan).
Status bakePiece(const std::string& job_folder, const jobs::Plan& plan, const jobs::Piece& piece, int threads,
                 const BakeEnvironment& environment);
// Writes the character and its report from finished pieces, and makes what is missing of them. The job folder stays.
Result<BakeReport> finishBake(const std::string& job_folder, const jobs::Plan& plan,
                              const BakeEnvironment& environment);

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Partition of a reconstruction into pieces for any machines with the same files (jobs/plan.h):
//   planning         everything before the frames (prepare.h), in one process
//   first-SEQ        frame 0 of a sequence, whose scale the other frames follow
//   frames-SEQ-K     a window of frames (sequence_frames.h)
//   finish           the report, and the new folder in its place
// The job folder is the work folder, CAPTURE2.work; frames are stored in CAPTURE2.part. `fourdvt reconstruct --resume`
// continues from finished pieces, and pieces from an interrupted run.
#pragma once

#include "jobs/plan.h"
#include "reconstruct/run/reconstruct.h"

namespace fourdvt::reconstruct {

// Prepares the frames and writes the plan. `arguments`: command line, recorded in the plan. Existing results of the
// same capture and settings are kept; pieces with missing frames are repeated. Needs no GPU. Errors: those of
// reconstruct; CaptureJson (a sequence name that is no valid piece name).
Result<jobs::Plan> planReconstruct(const ReconstructOptions& options, std::vector<std::string> arguments,
                                   const ReconstructEnvironment& environment);

// True if pieces other than the last require environment.device. Errors: those of reading the job folder.
Result<bool> piecesNeedDevice(const std::string& job_folder);

// Computes the missing part of a piece other than the last, of a plan by the same build. Any process may compute it,
// even several concurrently. Errors: those of reconstruct; InvalidArgument (files have changed).
Status reconstructPiece(const std::string& job_folder, const jobs::Piece& piece, int threads,
                        const ReconstructEnvironment& environment);

// Writes the report and moves the new folder into place; the job folder stays. Errors: InvalidArgument (missing
// frames), WriteFailed.
Result<ReconstructSummary> finishReconstruct(const std::string& job_folder, const ReconstructEnvironment& environment);

}  // namespace fourdvt::reconstruct

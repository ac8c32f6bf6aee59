// SPDX-License-Identifier: Apache-2.0
// A reconstruction cut into pieces that any machine with the same files can compute (jobs/plan.h):
//   planning         everything before the frames (prepare.h), in one process
//   first-SEQ        frame 0 of a sequence, whose scale the other frames follow
//   frames-SEQ-K     a window of frames (sequence_frames.h)
//   finish           the report, and the new folder in its place
// The job folder is the work folder, CAPTURE2.work, and frames go to CAPTURE2.part: what some pieces have finished,
// `fourdvt reconstruct --resume` goes on with, and the other way round.
#pragma once

#include "jobs/plan.h"
#include "reconstruct/run/reconstruct.h"

namespace fourdvt::reconstruct {

// Prepares the frames and writes the plan. `arguments`: the command line, for readers of the plan. What the folders
// have of the same capture and settings stays; a piece is done again where frames of it are gone. Needs no GPU. Errors:
// those of reconstruct; CaptureJson (a sequence whose name no piece can have).
Result<jobs::Plan> planReconstruct(const ReconstructOptions& options, std::vector<std::string> arguments,
                                   const ReconstructEnvironment& environment);

// True where pieces but the last need environment.device. Errors: those of reading the job folder.
Result<bool> piecesNeedDevice(const std::string& job_folder);

// Computes one piece but the last, of a plan that this build has made, or what is missing of it. Any process may
// compute it, several at once. Errors: those of reconstruct; InvalidArgument (files that have changed).
Status reconstructPiece(const std::string& job_folder, const jobs::Piece& piece, int threads,
                        const ReconstructEnvironment& environment);

// Writes the report and puts the new folder into place. The job folder stays. Errors: InvalidArgument (frames are
// missing), WriteFailed.
Result<ReconstructSummary> finishReconstruct(const std::string& job_folder, const ReconstructEnvironment& environment);

}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
// Partition of a tracking run into pieces for any machines with the same files (jobs/plan.h):
//   planning       everything before the fits (prepare.h), and the order of the frames, in one process
//   fits-SEQ-F     fits along a path down the tree of similar frames, which begins with frame F (frame_paths.h)
//   finish         repairs, the new folder and its report
// The job folder is the work folder, CAPTURE2.work, which has the fits. `fourdvt track --resume` continues from
// finished pieces, and pieces from an interrupted run.
#pragma once

#include "jobs/plan.h"
#include "track/run/track.h"

namespace fourdvt::track {

// Prepares the fits and writes the plan. `arguments`: command line, recorded in the plan. Existing results of the same
// capture and settings are kept; pieces with missing fits are repeated. Errors: those of track; CaptureJson (a sequence
// name that is no valid piece name).
Result<jobs::Plan> planTrack(const TrackOptions& options, std::vector<std::string> arguments,
                             const TrackEnvironment& environment);

// Computes the missing fits of a piece other than the last, of a plan by the same build. Any process may compute it,
// even several concurrently. Errors: those of track; InvalidArgument (files have changed).
Status trackPiece(const std::string& job_folder, const jobs::Piece& piece, int threads,
                  const TrackEnvironment& environment);

// Repairs bad fits, writes the result and moves it into place; the job folder stays. Errors: InvalidArgument (missing
// fits; files have changed), WriteFailed; those of writeResult (finish.h).
Result<TrackSummary> finishTrack(const std::string& job_folder, const TrackEnvironment& environment);

}  // namespace fourdvt::track

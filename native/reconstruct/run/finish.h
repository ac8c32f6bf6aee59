// SPDX-License-Identifier: Apache-2.0
// The end of a reconstruction: from its finished frames to the report. Does NOT put the new folder into place.
#pragma once

#include <optional>

#include "reconstruct/run/prepare.h"
#include "reconstruct/run/report.h"
#include "reconstruct/run/sequence_frames.h"

namespace fourdvt::reconstruct {

// The frame of a sequence that its report shows.
inline uint32_t shownFrame(const capture::CaptureSequence& sequence) { return sequence.frame_count / 2; }

// Draws a finished frame for the report, from its mesh; unlike a frame that was just made, without its hull. Errors:
// those of pictures and of readMeshFile.
Status drawKept(const Prepared& job, const FrameStore& store, const capture::CaptureSequence& sequence, uint32_t frame,
                const OpenVideo& open_video, ReportPictures& pictures);

// The run that made the frames.
struct RunTime {
  uint32_t frames_kept = 0;  // those that were there before it
  double wall_s = 0;
};

// Writes the report over all frames into the new folder. `run`: none where several processes made the frames; the
// report has the sum of the frames' seconds then, and is the same bytes whoever writes it. Errors: InvalidArgument (a
// frame that is not finished), WriteFailed.
Result<ReconstructSummary> writeResult(const Prepared& job, const FrameStore& store, const ReportPictures& pictures,
                                       const std::optional<RunTime>& run);

}  // namespace fourdvt::reconstruct

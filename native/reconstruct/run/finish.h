// SPDX-License-Identifier: Apache-2.0
// The end of a reconstruction: from its finished frames to the report. Does NOT put the new folder into place.
#pragma once

#include "reconstruct/run/frame_store.h"
#include "reconstruct/run/prepare.h"
#include "reconstruct/run/report.h"

namespace fourdvt::reconstruct {

// The frame of a sequence that its report shows.
inline uint32_t shownFrame(const capture::CaptureSequence& sequence) { return sequence.frame_count / 2; }

// Draws a finished frame for the report, from its mesh; unlike a frame that was just made, without its hull. Errors:
// those of pictures and of readMeshFile.
Status drawKept(const Prepared& job, const FrameStore& store, const capture::CaptureSequence& sequence, uint32_t frame,
                const OpenVideo& open_video, ReportPictures& pictures);

// Writes the report over all frames into the new folder. `frames_kept`: those that were there before this run. Errors:
// InvalidArgument (a frame that is not finished), WriteFailed.
Result<ReconstructSummary> writeResult(const Prepared& job, const FrameStore& store, const ReportPictures& pictures,
                                       uint32_t frames_kept, double wall_s);

}  // namespace fourdvt::reconstruct

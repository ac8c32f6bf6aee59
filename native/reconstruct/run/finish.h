// SPDX-License-Identifier: Apache-2.0
// Report of a reconstruction from its finished frames, without moving the new folder into place.
#pragma once

#include <optional>

#include "reconstruct/run/prepare.h"
#include "reconstruct/run/report.h"
#include "reconstruct/run/sequence_frames.h"

namespace fourdvt::reconstruct {

// Frame of a sequence shown in its report.
inline uint32_t shownFrame(const capture::CaptureSequence& sequence) { return sequence.frame_count / 2; }

// Draws a finished frame for the report from its mesh; without its hull, which is not stored. Errors: those of pictures
// and of readMeshFile.
Status drawKept(const Prepared& job, const FrameStore& store, const capture::CaptureSequence& sequence, uint32_t frame,
                const OpenVideo& open_video, ReportPictures& pictures);

// Statistics of the run that computed the frames.
struct RunTime {
  uint32_t frames_kept = 0;  // existed before the run
  double wall_s = 0;
};

// Writes the report over all frames into the new folder. `run`: none if several processes computed the frames; the
// report then has the sum of the frames' seconds and is byte-identical for any writer. Errors: InvalidArgument (an
// unfinished frame), WriteFailed.
Result<ReconstructSummary> writeResult(const Prepared& job, const FrameStore& store, const ReportPictures& pictures,
                                       const std::optional<RunTime>& run);

}  // namespace fourdvt::reconstruct

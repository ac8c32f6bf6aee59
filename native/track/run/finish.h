// SPDX-License-Identifier: Apache-2.0
// Result of a tracking run from its fits: failed frames are interpolated, the motion is smoothed in time, meshes,
// capture.json and report are written into the new folder.
#pragma once

#include <span>

#include "track/order.h"
#include "track/run/prepare.h"
#include "track/run/track.h"

namespace fourdvt::track {

// Writes into the existing folder `part`. Errors: InvalidArgument (a frame is not fitted; too many fits failed: the
// first one is named with the place that the template does not explain; a sequence that is to be a loop shows no
// cycle); WriteFailed; those of linkCapture.
Result<TrackSummary> writeResult(const Prepared& job, const Work& work, const ChosenTemplate& chosen,
                                 std::span<const TrackingStep> steps, const std::string& part);

}  // namespace fourdvt::track

// SPDX-License-Identifier: Apache-2.0
// Text of a studio capture's capture.json: the readers' fields (capture.h), and under "studio" the generating options
// and hidden values, which readers ignore.
#pragma once

#include <string>

#include "lab/studio/filming.h"
#include "lab/studio/set.h"

namespace fourdvt::studio {

// "studio"/"offset_frames_true" lists timeOffsets, if there are any. `room`: null for the green studio.
std::string captureText(const StudioSet& set, const StudioOptions& options, const Room* room);

}  // namespace fourdvt::studio

// SPDX-License-Identifier: Apache-2.0
// Checks of a sequence's videos by what their containers list, before long work: nothing is decoded.
#pragma once

#include "capture/capture.h"

namespace fourdvt::capture {

// Errors: VideoTooShort where a video has fewer pictures than the sequence needs, whatever its header counts, or lacks
// one between others that other cameras have: those after it would show a later instant. And those of `open_video`.
Status checkClips(const Capture& capture, const CaptureSequence& sequence, const OpenVideo& open_video,
                  MatteNeed mattes);

}  // namespace fourdvt::capture

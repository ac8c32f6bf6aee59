// SPDX-License-Identifier: Apache-2.0
// Checks a sequence's videos by their containers' listings, without decoding, before long work.
#pragma once

#include "capture/capture.h"

namespace fourdvt::capture {

// Errors: VideoTooShort where a video has fewer pictures than the sequence needs, by its listing rather than its
// header, or lacks one between others that other cameras have, so that later pictures would show a later instant. And
// those of `open_video`.
Status checkClips(const Capture& capture, const CaptureSequence& sequence, const OpenVideo& open_video,
                  MatteNeed mattes);

}  // namespace fourdvt::capture

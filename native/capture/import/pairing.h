// SPDX-License-Identifier: Apache-2.0
// Pairs the pictures of a take's cameras by the instants that they show: frames of the capture are the longest stretch
// of instants at which no camera lacks a picture or a matte.
#pragma once

#include "capture/import/instants.h"
#include "capture/import/takes.h"

namespace fourdvt::capture {

// `clips`: of the take's cameras, with instants; `mattes`: of those that have some. Sets frames, first_frame and
// offset_frames of the take, and takes the pictures that are no frame's out of its views. What a camera lacks, and what
// is left out for it, is noted. Errors: VideoTooShort (no instant is in all clips).
Status pairPictures(const std::vector<Clip>& clips, const std::vector<Clip>& mattes, Take& take, ClipNotes& notes);

}  // namespace fourdvt::capture

// SPDX-License-Identifier: Apache-2.0
// Pairs the pictures of a take's cameras by their instants: frames of the capture are the longest stretch of instants
// at which no camera lacks a picture or a matte.
#pragma once

#include "capture/import/instants.h"
#include "capture/import/takes.h"

namespace fourdvt::capture {

// `clips`: the take's cameras, with instants; `mattes`: cameras with mattes. Sets frames, first_frame and offset_frames
// of the take, and removes pictures outside the frames from its views. Notes missing pictures and what is left out
// because of them. Errors: VideoTooShort (no instant common to all clips).
Status pairPictures(const std::vector<Clip>& clips, const std::vector<Clip>& mattes, Take& take, ClipNotes& notes);

}  // namespace fourdvt::capture

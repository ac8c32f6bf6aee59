// SPDX-License-Identifier: Apache-2.0
// Test pictures of a capture: the performer alone, in the held-out cameras (capture::readTestCameras).
#pragma once

#include "capture/capture.h"

namespace fourdvt::measure {

// RGBA, straight alpha, of the camera's size. Errors: FrameSize, and those of readImage.
Result<Image> heldOutTruth(const capture::CaptureSequence& sequence, const PinholeCamera& camera, uint32_t frame);

}  // namespace fourdvt::measure

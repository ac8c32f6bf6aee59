// SPDX-License-Identifier: Apache-2.0
// Converts pictures as stored to pictures as a camera is calibrated for. The calibrated size, or else the user,
// determines which of the marks that turn or stretch a picture apply.
#pragma once

#include <string>

#include "base/image.h"
#include "base/result.h"
#include "capture/capture.h"

namespace fourdvt::capture {

// "mirrored and turned by 90°", "with pixels of 1.333 to 1"; empty if there are no marks.
std::string describe(const PictureMarks& marks);

// Stretches, mirrors and turns a picture with any number of channels.
Image applyMarks(Image stored, const PictureMarks& marks);

// Marks with which the picture has the camera's calibrated size. `path` is for messages. Errors: FrameSize (no choice
// of marks gives that size, or the rotation is ambiguous).
Result<PictureMarks> calibratedMarks(const Image& stored, const PictureMarks& marks, const CaptureCamera& camera,
                                     const std::string& path);

// Applies calibratedMarks. Errors: those of calibratedMarks.
Result<Image> asCalibrated(Image stored, const PictureMarks& marks, const CaptureCamera& camera,
                           const std::string& path);

// Error where `camera.orientation` leaves marks that turn a picture ambiguous.
Error orientationIsOpen(const PictureMarks& marks, const CaptureCamera& camera, const std::string& path);

}  // namespace fourdvt::capture

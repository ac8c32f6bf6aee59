// SPDX-License-Identifier: Apache-2.0
// Pictures as they lie in their files → pictures as a camera is calibrated for: marks that turn or stretch a picture
// belong to the calibration or not, which its size decides, or else the user.
#pragma once

#include <string>

#include "base/image.h"
#include "base/picture_marks.h"
#include "base/result.h"
#include "capture/capture.h"

namespace fourdvt::capture {

// Stretches, mirrors and turns a picture of any number of channels.
Image applyMarks(Image stored, const PictureMarks& marks);

// Those of a picture's marks with which it has the size that the camera is calibrated for. `path` is for messages.
// Errors: FrameSize (no choice of marks gives that size, or it is open whether the picture is to be turned).
Result<PictureMarks> calibratedMarks(const Image& stored, const PictureMarks& marks, const CaptureCamera& camera,
                                     const std::string& path);

// The picture with calibratedMarks applied. Errors: theirs.
Result<Image> asCalibrated(Image stored, const PictureMarks& marks, const CaptureCamera& camera,
                           const std::string& path);

// The error where `camera.orientation` does not decide on marks that turn a picture.
Error orientationIsOpen(const PictureMarks& marks, const CaptureCamera& camera, const std::string& path);

}  // namespace fourdvt::capture

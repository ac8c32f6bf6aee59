// SPDX-License-Identifier: Apache-2.0
// Plates of a camera: pictures of the empty studio in the capture's background folder.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "capture/capture.h"

namespace fourdvt::capture {

struct Plates {
  std::string path;             // path of the first plate
  std::vector<Image> pictures;  // RGB, as distorted as the videos
};

// Reads background/CAMERA.png, or else background/CAMERA/000000.png (or .jpg) and its successors up to a gap.
// `otherwise` ends the message if a plate cannot be read: the need for it, and the remedy. Errors: FileMissing,
// FileUnreadable, FrameSize.
Result<Plates> readPlates(const Capture& capture, const CaptureCamera& camera, const std::string& otherwise);

}  // namespace fourdvt::capture

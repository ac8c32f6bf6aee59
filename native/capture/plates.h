// SPDX-License-Identifier: Apache-2.0
// The plates of a camera: pictures of the empty studio in the capture's background folder.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "capture/capture.h"

namespace fourdvt::capture {

struct Plates {
  std::string path;             // of the first
  std::vector<Image> pictures;  // RGB, as distorted as the videos
};

// Reads background/CAMERA.png, or else background/CAMERA/000000.png (or .jpg) and what follows it without a gap.
// `otherwise` ends the message if a plate cannot be read: why it is needed, and the remedy.
// Errors: FileMissing, FileUnreadable, FrameSize.
Result<Plates> readPlates(const Capture& capture, const CaptureCamera& camera, const std::string& otherwise);

}  // namespace fourdvt::capture

// SPDX-License-Identifier: Apache-2.0
// Reads RIG.json: the calibrated cameras of a live stage, where each one's pictures come from, and where the performer
// moves. Does NOT open sources.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capture/capture.h"

namespace fourdvt::live {

// What FFmpeg opens. A file is played in a loop at its own pace, such that all cameras of a stage show the same moment.
struct SourcePlace {
  std::string url;                             // file (relative to the rig's folder), device or address
  std::string format;                          // FFmpeg's input format, e.g. "v4l2"; empty: told from the url
  std::map<std::string, std::string> options;  // FFmpeg's, of the input
};

struct RigCamera {
  capture::CaptureCamera camera;      // metres
  std::optional<SourcePlace> source;  // none: a live-camera on another machine sends it
};

struct Rig {
  std::string path, folder, name;
  double fps = 25;
  double ground_y_m = 0;
  BoundingBox bounds;  // metres; nothing outside is reconstructed
  std::vector<RigCamera> cameras;
  std::string background_folder;       // plates: CAMERA.png or CAMERA/000000.png …
  capture::Capture asCapture() const;  // calibration and plates as the capture's readers take them; no sequences
  const RigCamera* find(const std::string& camera) const;
};

// Errors: FileMissing, CaptureJson (a field of RIG.json), and those of readColmapCameras.
Result<Rig> readRig(const std::string& path);

}  // namespace fourdvt::live

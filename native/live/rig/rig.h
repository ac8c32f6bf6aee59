// SPDX-License-Identifier: Apache-2.0
// Reader of RIG.json: the calibrated cameras of a live stage, the sources of their pictures, and the performer's
// volume. Sources are opened in camera/source.h.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capture/capture.h"

namespace fourdvt::live {
// Input opened by FFmpeg. A file is played in a loop at its own rate, so that all cameras of a stage show the same
// moment.
struct SourcePlace {
  std::string url;                             // file (relative to the rig's folder), device or address
  std::string format;                          // FFmpeg's input format, e.g. "v4l2"; empty: derived from the url
  std::map<std::string, std::string> options;  // FFmpeg's input options
};

struct RigCamera {
  capture::CaptureCamera camera;      // metres; pictures are reduced by Rig::reduce
  capture::CaptureCamera filmed;      // calibration of sources and plates at full size
  std::optional<SourcePlace> source;  // none: provided by `live-camera` on another machine
};

struct Rig {
  std::string path, folder, name;
  double fps = 25;
  int reduce = 1;  // reduction factor per side of sources and plates
  double ground_y_m = 0;
  BoundingBox bounds;  // metres; reconstruction is limited to this box
  std::vector<RigCamera> cameras;
  std::string background_folder;       // plates: CAMERA.png or CAMERA/000000.png …
  capture::Capture asCapture() const;  // full-size cameras with their plates, without sequences
  const RigCamera* find(const std::string& camera) const;
};

// Plates of the empty stage, reduced, not undistorted. Errors: those of capture::readPlates, with `otherwise` appended.
Result<std::vector<Image>> readRigPlates(const Rig& rig, const RigCamera& camera, const std::string& otherwise);

// Errors: FileMissing, CaptureJson (a field of RIG.json), and those of readColmapCameras.
Result<Rig> readRig(const std::string& path);

// Bounding box of the space visible to all cameras, for a rig without bounds; computed from calibrations alone. World,
// metres: above the ground except for a hundredth of the box's height, with every camera outside. Accurate to about a
// fiftieth of the cameras' distance. None if no space is visible to all.
std::optional<BoundingBox> commonView(const std::vector<capture::CaptureCamera>& cameras, double ground_y_m);

}  // namespace fourdvt::live

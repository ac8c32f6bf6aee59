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
// Input that FFmpeg opens. A file is played in a loop at its own pace, such that all cameras of a stage show the same
// moment.
struct SourcePlace {
  std::string url;                             // file (relative to the rig's folder), device or address
  std::string format;                          // FFmpeg's input format, e.g. "v4l2"; empty: told from the url
  std::map<std::string, std::string> options;  // FFmpeg's, of the input
};

struct RigCamera {
  capture::CaptureCamera camera;      // metres; of pictures that Rig::reduce has made smaller
  capture::CaptureCamera filmed;      // as calibrated: of sources and plates as they come
  std::optional<SourcePlace> source;  // none: a live-camera on another machine sends it
};

struct Rig {
  std::string path, folder, name;
  double fps = 25;
  int reduce = 1;  // pixels of sources and plates, along each side, for one that is worked with
  double ground_y_m = 0;
  BoundingBox bounds;  // metres; nothing outside is reconstructed
  std::vector<RigCamera> cameras;
  std::string background_folder;       // plates: CAMERA.png or CAMERA/000000.png …
  capture::Capture asCapture() const;  // of the cameras as filmed, with their plates; no sequences
  const RigCamera* find(const std::string& camera) const;
};

// The pictures of the empty stage, reduced, with the lens's distortion. Errors: those of capture::readPlates, with
// `otherwise` at the end.
Result<std::vector<Image>> readRigPlates(const Rig& rig, const RigCamera& camera, const std::string& otherwise);

// Errors: FileMissing, CaptureJson (a field of RIG.json), and those of readColmapCameras.
Result<Rig> readRig(const std::string& path);

// The box of space that all cameras of a rig see, for a rig that names none. Does NOT look at pictures.

// World, metres: above the ground but for a hundredth of its height, with every camera outside. Accurate to about a
// fiftieth of the cameras' distance. None where no space is seen by all.
std::optional<BoundingBox> commonView(const std::vector<capture::CaptureCamera>& cameras, double ground_y_m);

}  // namespace fourdvt::live

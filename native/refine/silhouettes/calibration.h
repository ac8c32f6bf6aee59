// SPDX-License-Identifier: Apache-2.0
// Synchronises and calibrates a capture's cameras from silhouettes alone: time offsets of each sequence's cameras
// (fitTimes) and camera poses (fitRig), alternating until both converge. Assumes correct mattes and a majority of
// correct cameras. A camera changes only by a statistically significant amount; the rig's pose in the world and the
// time of the rig as a whole are not observable and stay. Reads no meshes. See algorithms/calibration.md.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "refine/silhouettes/rig_fit.h"

namespace fourdvt::refine {

struct CalibrationOptions {
  bool times = true, cameras = true;
  int max_frames = 8;  // limit of a time offset
};

struct CameraCalibration {
  std::string name;
  std::vector<CameraTime> times;   // [sequence] relative to the capture's offsets
  std::vector<char> time_changed;  // [sequence]
  bool turned = false;
  glm::dvec3 turn_deg{0}, turn_deviation_deg{0};  // rotation about the camera's own axes
  std::optional<CameraShift> shift;               // best change, pixels of the full pictures; none: unknown
  StickOut before, after;                         // pixels of the full pictures
  bool unexplained = false;                       // no pose makes its silhouettes consistent with the others'
};

// Frame of the camera with the largest outline error, if anything changed.
struct CalibrationPicture {
  std::string camera, sequence;
  uint32_t frame = 0;
  Image before, after;  // RGB: outlinePicture with the other cameras' hull
};

struct Calibration {
  std::vector<std::string> sequences;
  std::vector<CameraCalibration> by_camera;
  std::vector<PinholeCamera> cameras;  // full pictures
  std::vector<std::string> warnings;   // one line each
  uint32_t frames = 0;                 // frames used
  std::optional<CalibrationPicture> worst;
  bool changed() const;
};

// `on_progress` receives a stage and the finished share of the whole; returns false to stop. Errors: those of
// FrameReader; InvalidArgument (fewer than three cameras); Interrupted.
Result<Calibration> calibrate(const capture::Capture& capture, const OpenVideo& open_video,
                              const CalibrationOptions& options,
                              const std::function<bool(const std::string& what, double share)>& on_progress);

// Applies calibrated cameras and times to the capture. Frames for which a camera has no picture are dropped at the
// beginning (first_frame) and at the end; loops keep all frames.
void applyCalibration(const Calibration& calibration, capture::Capture& capture);

}  // namespace fourdvt::refine

// SPDX-License-Identifier: Apache-2.0
// Puts a capture's cameras in step and in place from silhouettes alone: offsets in time of each sequence's cameras
// (rig_times.h), then turns of cameras (rig_fit.h), by turns until both stay. What is trusted: most cameras, and the
// mattes. A camera moves only where the data ask for it clearly; nothing says how the whole rig stands in the world or
// which camera is on time. algorithms/calibration.md. Does NOT write files, does NOT look at meshes.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "refine/silhouettes/rig_fit.h"
#include "refine/silhouettes/rig_times.h"

namespace fourdvt::refine {

struct CalibrationOptions {
  bool times = true, cameras = true;
  int most_frames = 8;  // of an offset in time
};

struct CameraCalibration {
  std::string name;
  std::vector<CameraTime> times;   // [sequence] beyond the offsets that the capture has
  std::vector<char> time_changed;  // [sequence]
  bool turned = false;
  glm::dvec3 turn_deg{0}, turn_deviation_deg{0};  // about its own axes
  std::optional<CameraShift> shift;               // the best change's, in pixels of the full pictures; none: unknown
  StickOut before, after;                         // pixels of the full pictures
  bool unexplained = false;                       // no pose brings its silhouettes together with the others'
};

// A frame of the camera whose outlines stuck out most, if anything changed.
struct CalibrationPicture {
  std::string camera, sequence;
  uint32_t frame = 0;
  Image before, after;  // RGB: outlinePicture of the other cameras' hull
};

struct Calibration {
  std::vector<std::string> sequences;
  std::vector<CameraCalibration> by_camera;
  std::vector<PinholeCamera> cameras;  // of the full pictures
  std::vector<std::string> warnings;   // one line each
  uint32_t frames = 0;                 // looked at
  std::optional<CalibrationPicture> worst;
  bool changed() const;
};

// `on_progress`: what is done and its share of the whole; returns false to stop. Errors: those of FrameReader;
// InvalidArgument (fewer than three cameras); Interrupted.
Result<Calibration> calibrate(const capture::Capture& capture, const OpenVideo& open_video,
                              const CalibrationOptions& options,
                              const std::function<bool(const std::string& what, double share)>& on_progress);

// Gives the capture the calibrated cameras and times. Frames for which some camera has no picture are left out, at the
// beginning (first_frame) and at the end; loops keep theirs.
void applyCalibration(const Calibration& calibration, capture::Capture& capture);

}  // namespace fourdvt::refine

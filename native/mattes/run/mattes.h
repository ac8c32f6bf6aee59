// SPDX-License-Identifier: Apache-2.0
// Mattes for a capture: makes those of every camera without any, jointly with the others (joint_mattes.h).
//    pictures, plates or clips, hints → SEQUENCE/maskNN/000000.png … in a capture folder of links, and a report
// One frame is in memory at a time. Finished frames are kept; the result is put into place when all are done.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "mattes/run/options.h"

namespace fourdvt::mattes {

inline constexpr const char* kReportJson = "mattes.json";

inline constexpr const char* kGivenMattes = "the capture's mattes";

// One camera in one frame.
struct CameraFigures {
  double shift_pixels = 0, gain = 1, residual_levels = 0;  // plate to picture, see PlateFit
  double supported = 1, kept = 1;                          // see CameraMatte
  double share = 0;                                        // share of the picture that the performer covers
};
struct SequenceFigures {
  std::string name;
  std::vector<std::vector<CameraFigures>> frames;  // [frame][camera]; of a preview only its frames
  std::vector<uint32_t> numbers;                   // frame numbers
};

struct MattesSummary {
  uint32_t frames = 0, frames_kept = 0;  // kept: finished by an earlier run
  double wall_s = 0;
  std::vector<std::string> sources;  // [camera] see MatteSource::name, or kGivenMattes
  std::vector<SequenceFigures> sequences;
  std::vector<std::string> warnings;  // one line each
};

// Runs `fourdvt mattes`. Errors: those of openCapture and of pictures; InvalidArgument (hints, folders, silhouettes
// that no common volume explains, naming sequence and frame); WriteFailed; Interrupted.
Result<MattesSummary> makeMattes(const MattesOptions& options, const MattesEnvironment& environment);

// Makes the mattes of `capture` in a folder linked to it: SEQUENCE/maskNN/000000.png in `part_folder`, with the report;
// finished frames' figures in `work_folder`. Resumes where an earlier call stopped.
Result<MattesSummary> addMattes(const capture::Capture& capture, const std::string& part_folder,
                                const std::string& work_folder, const MattesOptions& options,
                                const MattesEnvironment& environment);

}  // namespace fourdvt::mattes

// SPDX-License-Identifier: Apache-2.0
// From a capture with or without meshes to a capture with a surface per frame, made from its silhouettes:
//   cameras' pictures and mattes → silhouettes → hull → surface → capture folder with links to the pictures, and report
// One frame is in memory at a time. Frames are kept as they are finished, beside the folder that is to be written;
// nothing is put into place before all are. Meshes that the capture has are not looked at.
#pragma once

#include <map>

#include "capture/capture.h"
#include "reconstruct/run/frame_figures.h"
#include "reconstruct/run/prepare.h"

namespace fourdvt::reconstruct {

struct ReconstructedSequence {
  std::string name;
  std::vector<FrameFigures> frames;
};

struct ReconstructSummary {
  uint32_t frames = 0, frames_kept = 0;  // kept: finished by an earlier run
  double wall_s = 0;
  double lowest_overlap = 1, mean_overlap = 1;
  double mean_cover = 0;              // share of the pictures that silhouettes cover
  double volume_m3 = 0, seen_m3 = 0;  // of the surface, mean; that more than half of the cameras see
  std::vector<std::string> warnings;  // one line each
};

// Errors: those of openCapture and of pictures; NothingVisible, naming sequence and frame; WriteFailed; Interrupted.
Result<ReconstructSummary> reconstruct(const ReconstructOptions& options, const ReconstructEnvironment& environment);

}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
// Reconstruction of a surface per frame from a capture's silhouettes; existing meshes of the capture are ignored:
//   cameras' pictures and mattes → silhouettes → hull → surface → capture folder with links to the pictures, and report
// Holds one frame in memory. Finished frames are stored beside the output folder, which is put into place after the
// last.
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
  double mean_cover = 0;              // share of the pictures covered by silhouettes
  double volume_m3 = 0, seen_m3 = 0;  // mean of the surfaces; seen by more than half of the cameras
  std::vector<std::string> warnings;  // one line each
};

// Errors: those of openCapture and of pictures; NothingVisible, with sequence and frame; WriteFailed; Interrupted.
Result<ReconstructSummary> reconstruct(const ReconstructOptions& options, const ReconstructEnvironment& environment);

}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
// Tracking of one mesh through all frames of a capture with surfaces of free topology:
//   surfaces, pictures and mattes → template → order of the frames → fits → smooth motion → capture folder with links
//   to the pictures, and report
// Holds the pictures of three frames. Of all frames it holds thumbnails for the order, and positions at the end.
#pragma once

#include <string>
#include <vector>

#include "track/run/options.h"
#include "track/run/work.h"

namespace fourdvt::track {

struct TrackSummary {
  uint32_t frames = 0, frames_kept = 0;  // kept: fitted by an earlier run
  uint32_t faces = 0, vertices = 0;
  FrameName template_frame;
  double wall_s = 0;  // run; of pieces the sum of all fits
  double mean_overlap = 0, lowest_overlap = 1;
  double distance_95_m = 0;           // mean over the frames
  uint32_t interpolated = 0;          // frames whose fit failed
  std::vector<std::string> loops;     // one line each
  std::vector<std::string> warnings;  // one line each
};

// Errors: those of prepare, storePictures and makeTemplateOf (prepare.h), and of finish (finish.h); Interrupted.
Result<TrackSummary> track(const TrackOptions& options, const TrackEnvironment& environment);

}  // namespace fourdvt::track

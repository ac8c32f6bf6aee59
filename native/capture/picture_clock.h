// SPDX-License-Identifier: Apache-2.0
// Clock of equal steps for a clip's pictures.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/video.h"

namespace fourdvt::capture {

struct PictureClock {
  // [picture] steps since picture 0, ascending; increments above 1 are lost pictures.
  std::vector<int64_t> instants;
  double step_s = 0;   // 0: only one picture
  double max_off = 0;  // maximum deviation of a picture from its instant, steps
};

// Fits a clock to a clip's times: the step is the median interval, and every picture lies at most half a step off its
// instant. nullopt where no such clock exists, or where more than one picture in ten is followed by a gap: the rate is
// variable.
std::optional<PictureClock> clockOf(const std::vector<double>& times_s);

struct ClockGap {
  size_t after = 0;   // number of the preceding picture
  uint64_t lost = 0;  // pictures
  double time_s = 0;  // first lost picture, since picture 0
};
// Gaps between the pictures begin…end-1.
std::vector<ClockGap> gapsOf(const PictureClock& clock, size_t begin, size_t end);

// Command that makes a clip's rate constant, "ffmpeg -i cam03.mp4 -vf fps=25 …": repeats the previous picture in gaps;
// keeps rotation marks, and alpha of WebM.
std::string constantRateCommand(const std::string& path, double fps);

}  // namespace fourdvt::capture

// SPDX-License-Identifier: Apache-2.0
// A clip's pictures on a clock of equal steps. Does NOT read files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/video.h"

namespace fourdvt::capture {

struct PictureClock {
  // [picture] steps since picture 0, ascending; a picture was lost wherever they go on by more than 1.
  std::vector<int64_t> instants;
  double step_s = 0;    // 0: there is one picture only
  double most_off = 0;  // steps that a picture lies off its instant
};

// Steps of a clip's times: the median interval sets them, and every picture lies at most half a step off its instant.
// nullopt where no such clock exists, or where more than one picture in ten is followed by a gap: the rate is variable.
std::optional<PictureClock> clockOf(const std::vector<double>& times_s);

struct ClockGap {
  size_t after = 0;   // number of the picture before it
  uint64_t lost = 0;  // pictures
  double time_s = 0;  // of the first one, since picture 0
};
// Gaps between the pictures begin…end-1.
std::vector<ClockGap> gapsOf(const PictureClock& clock, size_t begin, size_t end);

// "ffmpeg -i cam03.mp4 -vf fps=25 …": makes a clip's rate constant; a picture that is lacking
// repeats the one before; marks that turn pictures stay, and alpha of WebM.
std::string constantRateCommand(const std::string& path, double fps);

}  // namespace fourdvt::capture

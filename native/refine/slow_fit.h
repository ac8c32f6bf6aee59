// SPDX-License-Identifier: Apache-2.0
// Offsets that vary slowly with time, for meshes whose error depends on the pose.
#pragma once

#include <optional>

#include "capture/surface_offsets.h"
#include "refine/surface_fit.h"

namespace fourdvt::refine {

// What the outlines of one frame still lack, given the constant offsets.
struct SlowFrame {
  uint32_t index = 0;
  std::vector<std::vector<OffsetClaim>> claims;  // [camera]
};

// Departures from the constant offsets at the frames given, each from its neighbours in time. None where the data do
// not support them: the frames must be close in time, and what the cameras with even numbers say must bring the
// outlines closer in those with odd numbers. `loop_frames`: of a loop, else 0.
std::optional<capture::SlowOffsets> fitSlowOffsets(std::span<const SlowFrame> frames, std::span<const InnerEdge> edges,
                                                   size_t vertices, uint32_t loop_frames);

}  // namespace fourdvt::refine

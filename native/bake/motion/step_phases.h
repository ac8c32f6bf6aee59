// SPDX-License-Identifier: Apache-2.0
// Common phases of a class at which a foot comes down. Pure functions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace fourdvt::bake {

// Phases in 0..1, ascending, of one member's footfalls. frames: captured ones; source_frame: ClassMember::source_frame;
// loop_frames: frames of the member's loop, or 0; phases: their number in the class. Frames outside the pass are left
// out.
std::vector<double> stepPhases(std::span<const uint32_t> frames, std::span<const double> source_frame,
                               uint32_t loop_frames, uint32_t phases);

// The first member's footfalls, each at the mean of the phases that the members have nearest to it. The first member's
// alone where the members' numbers differ.
std::vector<double> meanSteps(const std::vector<std::vector<double>>& members, bool loop);

}  // namespace fourdvt::bake

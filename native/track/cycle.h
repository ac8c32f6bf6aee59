// SPDX-License-Identifier: Apache-2.0
// Loops from clips of a tracked mesh, and the travel of the body over the ground (algorithms/tracking.md).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/ground_motion.h"
#include "base/mesh.h"

namespace fourdvt::track {

struct Cycle {
  uint32_t first = 0, last = 0;  // frame `last` repeats frame `first`
  double error_m = 0;            // rms difference of both in pose and velocity
  double error_share = 0;        // relative to the pose's rms change within the cycle; about 1: nothing repeats
  GroundMotion travel;           // from `first` to `last`
};
// Finds the pair of frames min_frames to max_frames apart that differ least in pose and velocity, up to a motion over
// the ground, relative to what the pose changes in between; of lengths that are about as good, the shortest. Strides
// are whole: after half of one the pose is mirrored. Empty for fewer than min_frames + 1 frames, or fewer than three.
std::optional<Cycle> findCycle(std::span<const Positions> frames, uint32_t min_frames, uint32_t max_frames);

// Frames `first` to `last` - 1 of a clip, closed: frame n is frame 0 moved by `travel`. The positions stay in the room,
// where pictures show them.
struct Loop {
  std::vector<Positions> frames;
  GroundMotion travel;  // one pass
};
// Closes a cycle. Over up to `blend_frames` frames at one end, the clip fades into what it shows beyond the other end,
// so that velocities are continuous; this needs as many frames before `first`, or from `last` on. Without them the
// misfit is spread evenly over the loop, half of it at each end.
Loop closeCycle(std::span<const Positions> frames, const Cycle& cycle, uint32_t blend_frames);

// The body half way through a loop, in its heading there: its travel at a constant rate taken out of all frames.
struct Travel {
  glm::dvec3 place_m{0};       // mean over vertices and frames
  glm::dvec3 velocity_mps{0};  // at that place; y is 0
};
Travel travelOf(const Loop& loop, double fps);

}  // namespace fourdvt::track

// SPDX-License-Identifier: Apache-2.0
// Loops from clips of a tracked mesh, and the travel of the body over the ground (algorithms/tracking.md). The ground
// is the xz plane and y is up, as in captures.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::track {

// Rigid motion over the ground: a turn about the y axis, then a shift.
struct GroundMotion {
  double turn_rad = 0;    // positive from +z towards +x
  glm::dvec2 shift_m{0};  // along x and z
  glm::dvec3 operator()(const glm::dvec3& p) const;
};
// The share of a motion that a constant rate reaches after that share of its time; negative ones lead back, -1 is the
// inverse. Requires a turn of less than a whole one.
GroundMotion shareOf(const GroundMotion& motion, double share);

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

struct Travel {
  GroundMotion per_frame;
  glm::dvec3 velocity_mps{0};  // at the body's centroid, in its heading at frame 0; y is 0
};
// Travel at a constant rate over the ground: the motion that leads best (least squares over all vertices) from every
// frame to the one a period later. `period_frames`: of a cycle, whose swing then does not count, or else half of the
// clip; below the number of frames.
Travel travelOf(std::span<const Positions> frames, double fps, uint32_t period_frames);
Travel travelOf(const Loop& loop, double fps);

// Positions with the travel taken out, in place and heading of frame 0; bob and sway stay. This is the convention of
// captures on a treadmill, whose `root_velocity` is Travel::velocity_mps. Pictures of the room do not fit such
// positions: cameras stand still.
std::vector<Positions> onTheSpot(std::span<const Positions> frames, const GroundMotion& per_frame);

}  // namespace fourdvt::track

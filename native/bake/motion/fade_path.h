// SPDX-License-Identifier: Apache-2.0
// Finds pops: how far the mesh moves from tick to tick while one motion cross-fades into another as the player does it
// (player/parts/transitions.cpp), against how far the motions move by themselves. Where the fade moves the mesh
// further, the visitor sees a pop. Exact for the vertices given; whole frames are shown, so that fast motions now and
// then advance by one frame more between two ticks. Does NOT look at pictures, which change with the mean of the
// vertices' steps.
#pragma once

#include <cstdint>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::bake {

// How far the vertices move from one tick to the next, metres.
struct Step {
  double furthest = 0, mean = 0;
};
// In place, for a character that does not travel and so treads on the spot; and over the ground.
struct Steps {
  Step in_place, travelling;
};
Steps larger(const Steps& a, const Steps& b);

// A state at one of its weights.
struct MotionPath {
  double frames_per_s = 0;
  bool loop = false;
  std::vector<Positions> positions;   // [frame] chosen vertices, metres, character frame
  std::vector<glm::vec3> root_steps;  // [frame] to the next one, metres along x and z and radians, character frame
  std::vector<Steps> steps;           // [frame] to the next tick, as ownSteps returns them
};
// [frame] the steps of the motion by itself, with a tick every `tick_s`.
std::vector<Steps> ownSteps(const MotionPath& path, double tick_s);

struct Fade {
  uint32_t source_frame = 0, target_frame = 0;  // shown as it begins
  uint32_t frames = 1;                          // length, in frames of the target
  glm::vec3 shift{0};                           // motion::Entry::shift
};
struct PopOptions {
  double tick_s = 0.04;
  // The fade's mean step may reach this share of `PopScale::own`, or what either motion does by itself at that moment.
  double mean_share = 0.85;
  // If the two character frames lie further apart over the ground, metres, only travelling steps are compared: in
  // place such a motion must slide whichever frames meet.
  double furthest_shift_m = 0.3;
};
// What a fade's steps are compared with.
struct PopScale {
  Steps own;          // the largest steps of both motions by themselves
  double enough = 0;  // beyond this ratio the exact one does not matter
};
// The largest ratio of the fade's steps to `scale.own`; any ratio above `scale.enough` stands for all larger ones.
double popOf(const MotionPath& source, const MotionPath& target, const Fade& fade, const PopScale& scale,
             const PopOptions& options);

}  // namespace fourdvt::bake

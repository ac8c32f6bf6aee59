// SPDX-License-Identifier: Apache-2.0
// How far a mesh moves from look to look while one motion cross-fades into another as the player does it
// (player/parts/transitions.cpp), against how far the motions move by themselves: where it moves further, the fade is seen as
// a pop. Exact for the vertices given: whole frames are shown, of fast motions now and then one more between two looks.
// Does NOT look at pictures; they change with the mean of the vertices' steps, though more in some poses than in
// others.
#pragma once

#include <cstdint>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::bake {

// From one look to the next, metres.
struct Step {
  double furthest = 0, mean = 0;  // of the vertices
};
// In place, and over the ground: a character that does not travel treads on the spot.
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
  std::vector<Steps> steps;           // [frame] to the next look: ownSteps
};
// The character is looked at every look_s.
std::vector<Steps> ownSteps(const MotionPath& path, double look_s);

struct Fade {
  uint32_t source_frame = 0, target_frame = 0;  // shown as it begins
  uint32_t frames = 1;                          // of the target
  glm::vec3 shift{0};                           // motion::Entry::shift
};
struct PopOptions {
  double look_s = 0.04;
  // The mean step may reach this share of the largest, or what either motion does by itself at that moment.
  double mean_share = 0.85;
  // Metres over the ground between the two character frames. A motion captured further away must slide in place,
  // whichever frames meet: then only travelling counts.
  double furthest_shift_m = 0.3;
};
// The largest ratio of the fade's steps to `own`, the largest of both motions; once above `enough` any such ratio.
double popOf(const MotionPath& source, const MotionPath& target, const Fade& fade, const Steps& own,
             const PopOptions& options, double enough);

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// The motion graph's tables (algorithms/motion.md): s(a,b) = (1/N) min_T Σ ‖x_a − T x_b‖² + λ_v ‖v_a − T v_b‖² over yaw
// and ground translation, plus appearance as the distance of tiny layer-1 atlases (4DVT 6.1); for every frame and
// weight row of a state the best entry into every other state, and the length of the cross-fade, which must not move
// the mesh further from tick to tick than the motions do themselves. Does NOT play.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::bake {

// Finds pops: how far the mesh moves from tick to tick while one motion cross-fades into another as the player does it
// (player/parts/motion.cpp), against how far the motions move by themselves. Where the fade moves the mesh
// further, the visitor sees a pop. Exact for the vertices given; whole frames are shown, so that fast motions now and
// then advance by one frame more between two ticks. Does NOT look at pictures, which change with the mean of the
// vertices' steps.

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

// One state of the graph, as the tables need it.
struct TransitionState {
  uint32_t frame_count = 0;
  std::vector<double> frames_per_s;  // [weight row]
  bool loop = false;
  std::vector<std::vector<float>> weight_rows;  // the members' weights; {{1}} for a plain sequence
  // Vertices in metres, in the character frame.
  std::function<Result<Positions>(uint32_t weight_row, uint32_t frame)> positions;
  std::function<glm::vec3(uint32_t weight_row, uint32_t frame)> root;  // ChunkFrames::root, mixed
  // Layer 1, tiny (TransitionOptions::atlas texels a side), of the member with the row's largest weight; empty:
  // appearance costs nothing.
  std::function<Result<Image>(uint32_t weight_row, uint32_t frame)> atlas;
};

struct TransitionOptions {
  double velocity_weight = 0.04;  // λ_v, s²
  double appearance_mm = 60;      // cost of black against white
  int atlas = 32;                 // side in texels
  std::vector<double> fades_s = {0.4,  0.48, 0.56, 0.64,
                                 0.72, 0.8,  0.96, 1.2};  // lengths to choose from, the shortest first
  double fade_cost_mm_per_s = 20;   // per second beyond the shortest fade: a longer one must be worth it
  double hold_cost_mm_per_s = 100;  // per second that a source that does not loop stands on its last frame
  PopOptions pop;
  double max_pop = 1;           // the ratio to the motions' own steps up to which a pop costs nothing
  double pop_cost_mm = 100000;  // per ratio of 1 beyond max_pop: pops are the last resort
  int features = 400;           // vertices that the fit compares, spread over the surface
  // Most vertices whose steps are compared; fewer where those of all frames and rows would take more than `step_bytes`.
  int step_features = 20000;
  int64_t step_bytes = 256 << 20;
};

// Returns the bytes of the graph's file (motion/motion_graph.h). Memory: per frame and row the features and the
// vertices whose steps are compared. Errors: those of the callbacks, Interrupted (progress returned false).
Result<std::vector<uint8_t>> buildMotionGraph(const std::vector<TransitionState>& states,
                                              const TransitionOptions& options,
                                              const std::function<bool(double)>& progress);

}  // namespace fourdvt::bake

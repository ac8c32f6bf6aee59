// SPDX-License-Identifier: Apache-2.0
// The motion graph's tables (algorithms/motion.md): s(a,b) = (1/N) min_T Σ ‖x_a − T x_b‖² + λ_v ‖v_a − T v_b‖² over
// yaw and ground translation, plus appearance as the distance of tiny layer-1 atlases (D. Casas, M. Volino, J.
// Collomosse, A. Hilton: 4D Video Textures for Interactive Character Appearance, Computer Graphics Forum 33(2)
// (Eurographics), 2014; 4DVT 6.1); for every frame and weight row of a state the best entry into every other
// state, and the length of the cross-fade, which must not move the mesh further from tick to tick than the motions
// themselves do.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::bake {

// Measures pops: the mesh's movement from tick to tick during a cross-fade as the player renders it
// (player/parts/motion.cpp), relative to the movement of the motions by themselves. A larger movement is visible
// as a pop. Exact for the given vertices; whole frames are shown, so that fast motions occasionally advance by one
// frame more between two ticks. Pictures are ignored: their change follows the mean of the vertices' steps.

// Movement of the vertices from one tick to the next, metres.
struct Step {
  double furthest = 0, mean = 0;
};
// In place, for a character that treads on the spot; and over the ground.
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
// [frame] steps of the motion by itself, with a tick every `tick_s`.
std::vector<Steps> ownSteps(const MotionPath& path, double tick_s);

struct Fade {
  uint32_t source_frame = 0, target_frame = 0;  // frames at its beginning
  uint32_t frames = 1;                          // length, in frames of the target
  glm::vec3 shift{0};                           // motion::Entry::shift
};
struct PopOptions {
  double tick_s = 0.04;
  // Limit of the fade's mean step: this share of `PopScale::own`, or the current step of either motion by itself.
  double mean_share = 0.85;
  // Distance of the two character frames over the ground, metres, beyond which only travelling steps are compared: in
  // place such a motion slides for every pair of frames.
  double furthest_shift_m = 0.3;
};
// Reference for a fade's steps.
struct PopScale {
  Steps own;          // the largest steps of both motions by themselves
  double enough = 0;  // ratio beyond which the exact value is irrelevant
};
// Maximum ratio of the fade's steps to `scale.own`; values above `scale.enough` are lower bounds.
double popOf(const MotionPath& source, const MotionPath& target, const Fade& fade, const PopScale& scale,
             const PopOptions& options);

// One state of the graph: input of the tables.
struct TransitionState {
  uint32_t frame_count = 0;
  std::vector<double> frames_per_s;  // [weight row]
  bool loop = false;
  std::vector<std::vector<float>> weight_rows;  // the members' weights; {{1}} for a plain sequence
  // Vertices in metres, in the character frame.
  std::function<Result<Positions>(uint32_t weight_row, uint32_t frame)> positions;
  std::function<glm::vec3(uint32_t weight_row, uint32_t frame)> root;  // ChunkFrames::root, blended
  // Layer 1, tiny (TransitionOptions::atlas texels a side), of the member with the row's largest weight; empty: no
  // appearance cost.
  std::function<Result<Image>(uint32_t weight_row, uint32_t frame)> atlas;
};

struct TransitionOptions {
  double velocity_weight = 0.04;                                                // λ_v, s²
  double appearance_mm = 60;                                                    // cost of black against white
  int atlas = 32;                                                               // side in texels
  std::vector<double> fades_s = {0.4, 0.48, 0.56, 0.64, 0.72, 0.8, 0.96, 1.2};  // lengths to choose from, ascending
  double fade_cost_mm_per_s = 20;                                               // per second beyond the shortest fade
  double hold_cost_mm_per_s = 100;  // per second that a source that does not loop stands on its last frame
  PopOptions pop;
  double max_pop = 1;           // ratio to the motions' own steps up to which a pop is free
  double pop_cost_mm = 100000;  // per ratio of 1 beyond max_pop: pops are a last resort
  int features = 400;           // vertices compared by the fit, spread over the surface
  // Maximum number of vertices whose steps are compared; reduced where those of all frames and rows exceed
  // `step_bytes`.
  int step_features = 20000;
  int64_t step_bytes = 256 << 20;
};

// Returns the bytes of the graph's file (motion/motion_graph.h). Memory: per frame and row the features and the
// vertices whose steps are compared. Errors: those of the callbacks, Interrupted (progress returned false).
Result<std::vector<uint8_t>> buildMotionGraph(const std::vector<TransitionState>& states,
                                              const TransitionOptions& options,
                                              const std::function<bool(double)>& progress);

}  // namespace fourdvt::bake

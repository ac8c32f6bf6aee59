// SPDX-License-Identifier: Apache-2.0
// The motion graph's tables (ALGORITHMS 4.7): s(a,b) = (1/N) min_T Σ ‖x_a − T x_b‖² + λ_v ‖v_a − T v_b‖² over yaw and
// ground translation, plus appearance as the distance of tiny layer-1 atlases (4DVT 6.1); for every frame and weight
// row of a state the best entry into every other one, and the length of the cross-fade, such that it does not move the
// mesh further from look to look than the motions do themselves (fade_path.h). Does NOT play.
#pragma once

#include <functional>
#include <vector>

#include "bake/motion/fade_path.h"
#include "base/image.h"
#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::bake {

// One state as the tables see it.
struct TransitionState {
  uint32_t frame_count = 0;
  std::vector<double> frames_per_s;  // [weight row]
  bool loop = false;
  std::vector<std::vector<float>> weight_rows;  // members' weights; a plain sequence: {{1}}
  // Metres, character frame; any rows × frames.
  std::function<Result<Positions>(uint32_t weight_row, uint32_t frame)> positions;
  std::function<glm::vec3(uint32_t weight_row, uint32_t frame)> root;  // ChunkFrames::root, mixed
  // Layer 1, tiny (TransitionOptions::atlas texels a side), of the row's heaviest member; empty: no appearance cost.
  std::function<Result<Image>(uint32_t weight_row, uint32_t frame)> atlas;
};

struct TransitionOptions {
  double velocity_weight = 0.04;                                                // λ_v, s²
  double appearance_mm = 60;                                                    // cost of black against white
  int atlas = 32;                                                               // texels a side
  std::vector<double> fades_s = {0.4, 0.48, 0.56, 0.64, 0.72, 0.8, 0.96, 1.2};  // to choose from, shortest first
  double fade_cost_mm_per_s = 20;   // beyond the shortest: a longer fade must be worth it
  double hold_cost_mm_per_s = 100;  // while a source that does not loop stands on its last frame
  PopOptions pop;
  double max_pop = 1;          // of the motions' own steps; more costs
  double pop_cost_mm = 10000;  // of as much again: the last resort
  int features = 400;          // vertices looked at for the fit, spread over the surface
  int step_features = 4000;    // and for the steps
};

// Bytes of the graph file (motion/motion_graph.h). Memory: features a frame and row, not meshes. Errors: those of the
// callbacks, Interrupted (progress returned false).
Result<std::vector<uint8_t>> buildMotionGraph(const std::vector<TransitionState>& states,
                                              const TransitionOptions& options,
                                              const std::function<bool(double)>& progress);

}  // namespace fourdvt::bake

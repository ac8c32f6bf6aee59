// SPDX-License-Identifier: Apache-2.0
// Transitions between states (sequences and classes), precomputed at bake time (ALGORITHMS 4, 4DVT 6.1): for every
// frame and weight of a state, where to enter another one. Here: the table's reader and the choice at run time.
// Does NOT play anything; the player cross-fades.
// Layout of the file: FORMAT.md, "Motion graph".
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "package/character.h"

namespace fourdvt::motion {

struct Entry {              // from one frame and weight row of a state into another state
  uint32_t frame = 0;       // of the target
  uint32_t weight_row = 0;  // of the target: at which of its weights the fit was found
  float cost = 0;           // millimetres: rms of position and velocity difference, plus appearance
  glm::vec3 shift{0};       // target's character frame seen from the source's: metres along x and z, radians about y
};

struct GraphState {
  uint32_t frame_count = 0;
  std::vector<std::vector<float>> weight_rows;  // members' weights at which transitions were measured; plain: {{1}}
};

struct PlanOptions {
  double max_latency_s = 0.4;         // until the cross-fade begins
  double latency_cost_mm_per_s = 20;  // how much fit a second of waiting is worth
};

struct Transition {
  int source = -1, target = -1;  // sequence indices
  uint32_t exit_frame = 0;       // of the source: the cross-fade is centred on exit and entry
  uint32_t wait_frames = 0;      // from the frame asked at
  Entry entry;
};

class MotionGraph {
 public:
  // Checks counts against the character. Errors: StreamInvalid.
  static Result<MotionGraph> read(std::span<const uint8_t> bytes, const package::Character& character);
  // The best transition that begins within the latency bound; the source runs on at `frames_per_s`. A source that does
  // not loop stays on its last frame. Null: no such pair. weights: the source's members at present.
  std::optional<Transition> plan(int source, uint32_t frame, std::span<const float> weights, double frames_per_s,
                                 int target, const PlanOptions& options = {}) const;
  const std::vector<GraphState>& states() const { return states_; }  // one a sequence of the character
  // Null: no transition from source to target.
  const Entry* entry(int source, uint32_t frame, uint32_t weight_row, int target) const;

 private:
  std::vector<GraphState> states_;
  std::vector<bool> loops_;
  std::vector<std::vector<Entry>> tables_;  // [source * states + target][weight_row * frames + frame]; empty: none
};

// Native only (graph_encode.cpp): the file's bytes. tables as above.
std::vector<uint8_t> writeMotionGraph(const std::vector<GraphState>& states,
                                      const std::vector<std::vector<Entry>>& tables);

}  // namespace fourdvt::motion

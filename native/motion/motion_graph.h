// SPDX-License-Identifier: Apache-2.0
// Transitions between states (sequences and classes), precomputed at bake time (algorithms/motion.md, 4DVT 6.1): for
// every frame and weight of a state, where to enter another one and how long to cross-fade. Here: the table's reader
// and the choice at run time. Does NOT play anything; the player cross-fades. Latency is the time from the request to
// the first shown frame in which the target has a weight above 0. It includes fetching and decoding the target and the
// wait for a good frame, but not the fade, whose length the entry gives. Layout of the file: FORMAT.md, "The motion
// graph".
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "package/character.h"

namespace fourdvt::motion {

struct Entry {               // from one frame and weight row of a state into another state
  uint32_t frame = 0;        // of the target, shown as the cross-fade begins
  uint32_t weight_row = 0;   // of the target: at which of its weights the fit was found
  uint32_t fade_frames = 1;  // of the target, at least 1; after them the source is gone
  float cost =
      0;  // millimetres: rms difference of positions and velocities half way, appearance, length of the fade, pop
  glm::vec3 shift{0};  // target's character frame seen from the source's: metres along x and z, radians about y
};

struct GraphState {
  uint32_t frame_count = 0;
  std::vector<std::vector<float>> weight_rows;  // members' weights at which transitions were measured; plain: {{1}}
};

struct PlanOptions {                  // times count from the request
  double min_wait_s = 0;              // until the target can be shown
  double max_latency_s = 0.4;         // until the cross-fade begins
  double latency_cost_mm_per_s = 20;  // what a second of waiting costs
};

struct PlayedState {
  int source = -1;                 // sequence index
  uint32_t frame = 0;              // shown now
  std::span<const float> weights;  // of its members, now
  double frames_per_s = 0;         // at which it plays on
};

struct Transition {
  int source = -1, target = -1;  // sequence indices
  uint32_t exit_frame = 0;       // of the source, shown as the cross-fade begins
  uint32_t wait_frames = 0;      // from the frame shown at the request
  Entry entry;
};

class MotionGraph {
 public:
  // Checks counts against the character. Errors: StreamInvalid.
  static Result<MotionGraph> read(std::span<const uint8_t> bytes, const package::Character& character);
  // The best transition that begins within the latency bound, or the soonest one if none does. While it waits, the
  // source plays on; one that does not loop stays on its last frame. Null: the graph has no such transition.
  std::optional<Transition> plan(const PlayedState& from, int target, const PlanOptions& options = {}) const;
  const std::vector<GraphState>& states() const { return states_; }  // one per sequence of the character
  // Null: no transition from source to target.
  const Entry* entry(int source, uint32_t frame, uint32_t weight_row, int target) const;

 private:
  std::vector<GraphState> states_;
  std::vector<uint8_t> loops_;              // 0 or 1; vector<bool> takes more code
  std::vector<std::vector<Entry>> tables_;  // [source * states + target][weight_row * frames + frame]; empty: none
};

// The target's weight when it has shown so many frames since the cross-fade began: above 0 from the first one on, and
// rising smoothly to 1 at fade_frames.
float fadeWeight(double frames, uint32_t fade_frames);

// Native only (graph_encode.cpp): the file's bytes. tables as above.
std::vector<uint8_t> writeMotionGraph(const std::vector<GraphState>& states,
                                      const std::vector<std::vector<Entry>>& tables);

// Constants of the file.
constexpr uint32_t kGraphMagic = 0x47564434;  // "4DVG"
constexpr uint16_t kGraphVersion = 2;
constexpr uint32_t kGraphEntryBytes = 24;

}  // namespace fourdvt::motion

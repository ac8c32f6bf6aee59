// SPDX-License-Identifier: Apache-2.0
// Transitions between states (sequences and classes), precomputed by the bake (algorithms/motion.md, 4DVT 6.1): for
// every frame and weight row of a state, the frame at which to enter another state and the length of the cross-fade.
// Contains the table's reader and the choice at run time; the player cross-fades.
// Latency: time from the request to the first shown frame in which the target's weight is above 0. It includes fetching
// and decoding the target and the wait for a good exit frame, but excludes the fade, whose length the entry gives.
// File layout: FORMAT.md, "The motion graph".
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "package/character.h"

namespace fourdvt::motion {

struct Entry {               // transition from one frame and weight row of a state into another state
  uint32_t frame = 0;        // target frame shown as the cross-fade begins
  uint32_t weight_row = 0;   // target weight row for which the fit was computed
  uint32_t fade_frames = 1;  // cross-fade length in target frames, at least 1; the source's weight is 0 after them
  float cost = 0;      // millimetres: rms of position and velocity differences half way, appearance, fade length, pop
  glm::vec3 shift{0};  // target's character frame seen from the source's: metres along x and z, radians about y
};

struct GraphState {
  uint32_t frame_count = 0;
  std::vector<std::vector<float>> weight_rows;  // member weights with measured transitions; plain sequence: {{1}}
};

struct PlanOptions {                  // times from the request
  double min_wait_s = 0;              // earliest time at which the target is ready
  double max_latency_s = 0.4;         // limit for the start of the cross-fade
  double latency_cost_mm_per_s = 20;  // cost per second of waiting
};

struct PlayedState {
  int source = -1;                 // sequence index
  uint32_t frame = 0;              // frame on screen
  std::span<const float> weights;  // present weights of its members
  double frames_per_s = 0;         // present frame rate
};

struct Transition {
  int source = -1, target = -1;  // sequence indices
  uint32_t exit_frame = 0;       // source frame shown as the cross-fade begins
  uint32_t wait_frames = 0;      // counted from the frame shown at the request
  Entry entry;
};

class MotionGraph {
 public:
  // Checks counts against the character. Errors: StreamInvalid.
  static Result<MotionGraph> read(std::span<const uint8_t> bytes, const package::Character& character);
  // Minimum-cost transition that begins within the latency bound, or the soonest one if none does. During the wait the
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

// Target weight after `frames` target frames of the cross-fade: above 0 from the first frame, rising smoothly to 1 at
// fade_frames.
float fadeWeight(double frames, uint32_t fade_frames);

// Serialises the file; tables as above. Native only (graph_encode.cpp).
std::vector<uint8_t> writeMotionGraph(const std::vector<GraphState>& states,
                                      const std::vector<std::vector<Entry>>& tables);

// File constants.
constexpr uint32_t kGraphMagic = 0x47564434;  // "4DVG"
constexpr uint16_t kGraphVersion = 2;
constexpr uint32_t kGraphEntryBytes = 24;

}  // namespace fourdvt::motion

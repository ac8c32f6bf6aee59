// SPDX-License-Identifier: Apache-2.0
// Leads from one state (a sequence or class, a node of the motion graph) to another: waits for graph and header,
// chooses where to leave the source and where to enter the target (native/ALGORITHMS.md, section 4), waits for both,
// runs the fade; and remembers which state to return to after one that does not loop. A state machine over what the
// player tells it (TransitionView). Does NOT touch tracks, clocks or meshes: each step says what the player is to do.
//
// Phases: None → begin → Wanted → plan → Preparing → startFade → Fading → finish or cancel → None. A step in Preparing
// may plan again when the target was late. Every phase may be cancelled.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "motion/motion_graph.h"

namespace fourdvt {

// What a transition sees of the player at a tick.
struct TransitionView {
  double now_s = 0, tick_s = 0;  // the tick's time, and how long the one before is ago
  bool held = false;             // paused, or the source itself is not on screen yet
  // The source, as it is shown:
  int source = -1;
  const package::Sequence* sequence = nullptr;
  bool loops = false;
  int64_t k = 0;       // presentation
  double clock_s = 0;  // the clock's position and rate, in seconds at the sequence's own fps
  double clock_rate = 1;
  std::span<const float> weights;
  // What is there of the way:
  const motion::MotionGraph* graph = nullptr;  // null: not there
  bool graph_failed = false;
  bool target_has_header = false;
  bool target_fetched = false;   // what the second track is fed next is there
  bool target_prepared = false;  // the second track shows the target's first frame

  uint32_t frame() const { return static_cast<uint32_t>(k % sequence->frame_count); }
};

class Transitions {
 public:
  enum class Phase { None, Wanted, Preparing, Fading };
  // What the player is to do after a step. Select: cut to the target.
  enum class Step { Nothing, Plan, StartFade, Select };
  // Where to enter the target.
  struct Entrance {
    int64_t frame = 0;
    const std::vector<float>* weights = nullptr;  // one a member of the target
    bool anew = true;                             // else the target is being prepared there already
  };

  Phase phase() const { return run_.phase; }
  bool fading() const { return run_.phase == Phase::Fading; }
  int target() const { return run_.target; }  // -1: no transition
  const glm::vec3& shift() const { return run_.shift; }
  float fade() const { return run_.fade; }     // the target's share, 0..1
  int goal() const { return goal_; }           // state that was asked for last
  int returnTo() const { return return_to_; }  // state to lead back to from one that does not loop; -1: none

  void setGoal(int goal) { goal_ = goal; }
  void forgetReturn() { return_to_ = -1; }
  // A state is asked for; the latency bound counts from here. True: taken up when the present fade is over.
  bool ask(int goal, double now_s);
  void askReturn(double now_s);  // returnTo() is the goal, as if it were asked for now
  void begin(int target, double now_s);
  Step step(const TransitionView& view);
  // Null: the graph has no way to the target. `to`: the target's sequence.
  std::optional<Entrance> plan(const TransitionView& view, const package::Sequence& to, bool to_loops);
  void startFade() { run_.phase = Phase::Fading; }
  // target_frames: the target's clock, in its frames. True: the fade took a step. It does so when either track shows a
  // new picture, and at its end.
  bool stepFade(double target_frames, bool new_picture);
  // `entered` is shown instead of `left` from now on: a state that does not loop leads back to the one that does.
  void finish(int left, bool left_loops, bool entered_loops);
  void cancel(int current);  // whatever was on its way is given up; the current state is the goal
  // Whether to lead back now: as late as leaves room for the choice and for the fade. Else a cut after the end.
  bool returnDue(const TransitionView& view, const package::Sequence& to) const;

 private:
  struct Run {
    Phase phase = Phase::None;
    int target = -1;
    glm::vec3 shift{0};        // target's character frame seen from the source's
    int64_t begin_k = 0;       // source presentation at which the fade begins
    int64_t entry_k = 0;       // the target's then
    uint32_t fade_frames = 0;  // of the target
    float fade = 0;
    double patient_since_s = 0, prepared_since_s = 0;
    bool measured = false;  // lead_s_ knows how long this preparation took
  };

  Run run_;
  int goal_ = -1, return_to_ = -1;
  double asked_s_ = 0;    // when the goal was asked for: the tick before; later, where it could not play since
  double lead_s_ = 0.12;  // what preparing a target takes
};

}  // namespace fourdvt

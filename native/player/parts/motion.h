// SPDX-License-Identifier: Apache-2.0
// Motion of a character: parameters of classes, transitions between states, root motion. Meshes are blended and frames
// chosen elsewhere (figure.h, playback.h).
#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "motion/blend.h"
#include "motion/motion_graph.h"
#include "motion/placement.h"
#include "package/character.h"
#include "player/parts/figure.h"

namespace fourdvt {

// ---- parameters of classes ("speed_mps") ----

// Requested values by name, for all sequences.
class Parameters {
 public:
  explicit Parameters(double rate) : rate_(rate) {}
  void set(const std::string& name, double value) { wanted_[name] = value; }
  // Requested value of a class's parameter, by default the first member's; clamped to its range.
  double wanted(const package::Sequence& sequence, size_t parameter) const;
  double rate() const { return rate_; }  // maximum change of a shown value per second, in units of its range

 private:
  std::map<std::string, double> wanted_;
  double rate_;
};

// Parameter values whose weights are nearest to these; empty: a sequence without parameters.
std::vector<double> parametersAt(const package::Sequence& sequence, const std::vector<float>& weights);

// Shown parameter values of one track, which glide to the requested ones, and their blend weights.
class ShownParameters {
 public:
  // Start values of the next `enter` instead of the requested ones; empty: the requested ones.
  void setEntry(std::vector<double> values) { entry_ = std::move(values); }
  bool hasEntry() const { return !entry_.empty(); }
  void enter(const package::Sequence& sequence, const Parameters& parameters);  // switches to another sequence
  // Moves towards the requested values by `dt_s`. True: the weights changed.
  bool glide(const package::Sequence& sequence, const Parameters& parameters, double dt_s);
  double value(size_t parameter) const { return values_[parameter]; }
  const motion::BlendWeights& weights() const { return weights_; }

 private:
  std::vector<double> values_;  // parameters of the shown sequence
  std::vector<double> entry_;
  motion::BlendWeights weights_;
};

// ---- transitions ----

// Player state at a tick, as input of a transition.
struct TransitionView {
  double now_s = 0, tick_s = 0;  // time of the tick, and since the previous one
  bool held = false;             // paused, or the source is not on screen yet
  // Shown source:
  int source = -1;
  const package::Sequence* sequence = nullptr;
  bool loops = false;
  int64_t k = 0;       // presentation
  double clock_s = 0;  // clock position and rate, in seconds at the sequence's own fps
  double clock_rate = 1;
  std::span<const float> weights;
  // Loaded parts of the path:
  const motion::MotionGraph* graph = nullptr;  // null: not loaded
  bool graph_failed = false;
  bool target_has_header = false;
  bool target_fetched = false;   // data for the second track's next samples is loaded
  bool target_prepared = false;  // the target's first frame is ready on the second track

  uint32_t frame() const { return static_cast<uint32_t>(k % sequence->frame_count); }
};

// Transition from one state (a sequence or class, a node of the motion graph) to another: waits for graph and header,
// chooses exit and entry frames (algorithms/motion.md), waits for the source's exit frame and the target's pictures,
// runs the fade; keeps the state to return to after one that does not loop. A state machine over TransitionViews: each
// step returns the player's next action on tracks, clocks and meshes.
//
// Phases: None → begin → Wanted → plan → Preparing → startFade → Fading → finish or cancel → None. A step in Preparing
// may plan again if the target is late. Every phase may be cancelled.
class Transitions {
 public:
  enum class Phase { None, Wanted, Preparing, Fading };
  // Player's action after a step. Select: cut to the target.
  enum class Step { Nothing, Plan, StartFade, Select };
  // Entry into the target.
  struct Entrance {
    int64_t frame = 0;
    const std::vector<float>* weights = nullptr;  // one per target member
    bool anew = true;                             // false: this entry is being prepared already
  };

  Phase phase() const { return run_.phase; }
  bool fading() const { return run_.phase == Phase::Fading; }
  int target() const { return run_.target; }  // -1: no transition
  const glm::vec3& shift() const { return run_.shift; }
  float fade() const { return run_.fade; }     // target's share, 0..1
  int goal() const { return goal_; }           // last requested state
  int returnTo() const { return return_to_; }  // state to return to from one that does not loop; -1: none

  void setGoal(int goal) { goal_ = goal; }
  void forgetReturn() { return_to_ = -1; }
  // Requests a state; starts the latency bound. True: deferred until the present fade is over.
  bool ask(int goal, double now_s);
  void askReturn(double now_s);  // requests returnTo() as the goal
  void begin(int target, double now_s);
  Step step(const TransitionView& view);
  // Null: the graph has no path to the target. `to`: the target's sequence.
  std::optional<Entrance> plan(const TransitionView& view, const package::Sequence& to, bool to_loops);
  void startFade() { run_.phase = Phase::Fading; }
  // target_frames: position of the target's clock, in its frames. Returns true if the fade advanced: with a new picture
  // on either track, and at the end.
  bool stepFade(double target_frames, bool new_picture);
  // Ends the transition; `entered` becomes the shown state. If it does not loop, it returns to `left`, or, if `left`
  // does not loop either, to the state that `left` was to return to.
  void finish(int left, bool left_loops, bool entered_loops);
  void cancel(int current);  // discards the transition; the current state becomes the goal
  // Returns true when the return should begin: as late as the choice of an exit and the fade permit. A return that has
  // not begun by the end becomes a cut.
  bool returnDue(const TransitionView& view, const package::Sequence& to) const;

 private:
  struct Run {
    Phase phase = Phase::None;
    int target = -1;
    glm::vec3 shift{0};        // target's character frame seen from the source's
    int64_t begin_k = 0;       // source presentation at the start of the fade
    int64_t entry_k = 0;       // target presentation at the start of the fade
    uint32_t fade_frames = 0;  // in target frames
    float fade = 0;
    double patient_since_s = 0, prepared_since_s = 0;
    bool measured = false;  // lead_s_ includes this preparation
  };

  Run run_;
  int goal_ = -1, return_to_ = -1;
  double asked_s_ = 0;    // time of the request (the tick before it), or of a later resumption
  double lead_s_ = 0.12;  // estimated preparation time of a target
};

// ---- root motion ----

// Placement of the character on the ground: set by the page, turned towards a requested heading, moved by the root
// motion of the shown frames. During a fade both tracks move it by their shares, and the placement changes continuously
// from the source's to the target's along the shift between them.
class RootMotion {
 public:
  enum class Side { Source, Target };  // track of a step; without a fade, Source

  explicit RootMotion(double turn_rate_rad_s) : turn_rate_rad_s_(turn_rate_rad_s) {}

  void setTravel(bool on) { travel_ = on; }  // off: steps leave the placement unchanged
  // Sets the placement and ends steering; non-finite values are ignored.
  void place(const motion::Placement& placement);
  void steer(double heading_rad);
  void turn(double dt_s);  // towards the requested heading

  // Applies a step in the character's frame: metres along x and z, radians about y.
  void move(const glm::vec3& step, Side side);
  const motion::Placement& placement() const { return placement_; }
  // Placement of the source's character frame, which the mesh is drawn in; without a fade equal to placement().
  motion::Placement sourcePlacement() const;

  // shift: target's character frame seen from the source's, as motion::Entry.
  void beginFade(const glm::vec3& shift);
  void setFade(float fade);               // target's share, 0..1
  void finishFade() { fading_ = false; }  // the target becomes the source
  void cancelFade();                      // keeps the source's placement

 private:
  void setSourcePlacement(const motion::Placement& placement);

  double turn_rate_rad_s_;
  motion::Placement placement_;
  std::optional<double> wanted_heading_rad_;
  bool travel_ = false, fading_ = false;
  glm::vec3 shift_{0};
  float fade_ = 0;
};

// Frame about to be shown on a track.
struct RootFrame {
  const package::Sequence& sequence;
  std::span<const float> weights;  // one per member
  const FrameGeometry& geometry;
};

// Root values, per member, of a track's last frame, to compare the next frame's with.
class RootTrail {
 public:
  // Moves the character from the stored frame to this one, `passes` loop ends later.
  void lead(RootMotion& motion, RootMotion::Side side, const RootFrame& to, int64_t passes) const;
  void keep(const RootFrame& frame);

 private:
  std::array<glm::vec3, package::kMaxMembers> roots_{};
};

}  // namespace fourdvt

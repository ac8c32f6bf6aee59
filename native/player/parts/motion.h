// SPDX-License-Identifier: Apache-2.0
// Motion of a character: parameters of classes, transitions between states, root motion. Does NOT blend meshes and does
// NOT choose frames.
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

// --- parameters of classes ("speed_mps") ---

// The values that are wanted, by name, whatever is played.
class Parameters {
 public:
  explicit Parameters(double rate) : rate_(rate) {}
  void set(const std::string& name, double value) { wanted_[name] = value; }
  // Value of a class's parameter: as set, else as of its first member; within its range.
  double wanted(const package::Sequence& sequence, size_t parameter) const;
  double rate() const { return rate_; }  // a shown value crosses its whole range at most this often a second

 private:
  std::map<std::string, double> wanted_;
  double rate_;
};

// The parameter values whose weights are nearest to these; none: the sequence has no parameters.
std::vector<double> parametersAt(const package::Sequence& sequence, const std::vector<float>& weights);

// The values that one track shows, which glide to the wanted ones, with the blend weights that follow from them.
class ShownParameters {
 public:
  // The next `enter` begins at these values instead of the wanted ones; none: at the wanted ones.
  void setEntry(std::vector<double> values) { entry_ = std::move(values); }
  bool hasEntry() const { return !entry_.empty(); }
  void enter(const package::Sequence& sequence, const Parameters& parameters);  // another sequence is shown from now on
  // A step of `dt_s` towards the wanted values. True: the weights changed.
  bool glide(const package::Sequence& sequence, const Parameters& parameters, double dt_s);
  double value(size_t parameter) const { return values_[parameter]; }
  const motion::BlendWeights& weights() const { return weights_; }

 private:
  std::vector<double> values_;  // of the shown sequence's parameters
  std::vector<double> entry_;
  motion::BlendWeights weights_;
};

// --- transitions ---

// State of the player that a transition depends on, at a tick.
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
  // Parts of the way that are there:
  const motion::MotionGraph* graph = nullptr;  // null: not there
  bool graph_failed = false;
  bool target_has_header = false;
  bool target_fetched = false;   // what the second track is fed next is there
  bool target_prepared = false;  // the second track shows the target's first frame

  uint32_t frame() const { return static_cast<uint32_t>(k % sequence->frame_count); }
};

// Leads from one state (a sequence or class, a node of the motion graph) to another: waits for graph and header,
// chooses where to leave the source and where to enter the target (algorithms/motion.md), waits for both,
// runs the fade; and remembers which state to return to after one that does not loop. A state machine over
// TransitionViews. Does NOT touch tracks, clocks or meshes: each step returns what the player is to do.
//
// Phases: None → begin → Wanted → plan → Preparing → startFade → Fading → finish or cancel → None. A step in Preparing
// may plan again when the target was late. Every phase may be cancelled.
class Transitions {
 public:
  enum class Phase { None, Wanted, Preparing, Fading };
  // Work for the player after a step. Select: cut to the target.
  enum class Step { Nothing, Plan, StartFade, Select };
  // Entry into the target.
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
  // True: it is time to lead back, as late as leaves room for the choice and for the fade. Else it is a cut after the
  // end.
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

// --- root motion ---

// Place of the character on the ground: set by the page, turned towards a wanted heading, moved by the root
// motion of the frames shown. During a fade between two states both tracks move it, each by its share, and the
// placement goes over from the source's place to the target's along the shift between them, so that it does not jump.
class RootMotion {
 public:
  enum class Side { Source, Target };  // the track that a step is of; without a fade there is the source only

  explicit RootMotion(double turn_rate_rad_s) : turn_rate_rad_s_(turn_rate_rad_s) {}

  void setTravel(bool on) { travel_ = on; }  // off: steps do not move the character
  // Non-finite values are ignored. Placing ends steering.
  void place(const motion::Placement& placement);
  void steer(double heading_rad);
  void turn(double dt_s);  // towards the wanted heading

  // A step in the character's frame: metres along x and z, radians about y.
  void move(const glm::vec3& step, Side side);
  const motion::Placement& placement() const { return placement_; }
  // Placement of the source's character frame, in which the mesh is drawn; without a fade as placement().
  motion::Placement sourcePlacement() const;

  // shift: the target's character frame seen from the source's, as of motion::Entry.
  void beginFade(const glm::vec3& shift);
  void setFade(float fade);               // the target's share, 0..1
  void finishFade() { fading_ = false; }  // the target is the source from now on
  void cancelFade();                      // the source stays where it is

 private:
  void setSourcePlacement(const motion::Placement& placement);

  double turn_rate_rad_s_;
  motion::Placement placement_;
  std::optional<double> wanted_heading_rad_;
  bool travel_ = false, fading_ = false;
  glm::vec3 shift_{0};
  float fade_ = 0;
};

// A frame that a track is about to show.
struct RootFrame {
  const package::Sequence& sequence;
  std::span<const float> weights;  // one a member
  const FrameGeometry& geometry;
};

// Root values of the frame that a track shows, per member: what the next frame's are compared with.
class RootTrail {
 public:
  // Moves the character from the kept frame to this one, which lies `passes` ends of the loop later.
  void lead(RootMotion& motion, RootMotion::Side side, const RootFrame& to, int64_t passes) const;
  void keep(const RootFrame& frame);

 private:
  std::array<glm::vec3, package::kMaxMembers> roots_{};
};

}  // namespace fourdvt

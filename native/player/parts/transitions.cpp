// SPDX-License-Identifier: Apache-2.0
#include "player/parts/transitions.h"

#include <algorithm>

#include "motion/parameter_space.h"

namespace fourdvt {

namespace {

constexpr double kMaxLatency_s = 0.4;     // from the request until the fade begins, if the target is prepared in time
constexpr double kReturnChoice_s = 0.12;  // room for a good exit before the end of a state that does not loop
constexpr double kPatience_s = 5;         // with a decoder that gives nothing; then the target is simply selected
constexpr double kMinLead_s = 0.05, kMaxLead_s = 2;

}  // namespace

bool Transitions::ask(int goal, double now_s) {
  if (goal != goal_) asked_s_ = now_s;
  if (fading()) goal_ = goal;
  return fading();
}

void Transitions::askReturn(double now_s) {
  asked_s_ = now_s;
  goal_ = return_to_;
}

void Transitions::begin(int target, double now_s) {
  run_ = {};
  run_.phase = Phase::Wanted;
  run_.target = target;
  run_.patient_since_s = now_s;
}

Transitions::Step Transitions::step(const TransitionView& view) {
  if (view.held) asked_s_ = view.now_s;
  // While the network owes something the source plays on, however long that takes.
  if (view.held || !(view.target_fetched || view.target_prepared)) run_.patient_since_s = view.now_s;
  if (view.held || (run_.phase != Phase::Wanted && run_.phase != Phase::Preparing)) return Step::Nothing;
  if (view.graph_failed || view.now_s - run_.patient_since_s > kPatience_s) return Step::Select;
  if (!view.graph || !view.target_has_header) return Step::Nothing;
  if (run_.phase == Phase::Wanted) return Step::Plan;
  if (view.target_prepared && !run_.measured) {
    run_.measured = true;
    lead_s_ = std::clamp(1.25 * (view.now_s - run_.prepared_since_s), kMinLead_s, kMaxLead_s);
  }
  const bool at_end = !view.loops && view.frame() + 1 == view.sequence->frame_count;
  if (view.k < run_.begin_k && !at_end) return Step::Nothing;
  if (view.target_prepared) return Step::StartFade;
  if (!at_end && view.k <= run_.begin_k + 1) return Step::Nothing;
  lead_s_ = std::min(2 * lead_s_, kMaxLead_s);  // the target is late
  return Step::Plan;
}

std::optional<Transitions::Entrance> Transitions::plan(const TransitionView& view, const package::Sequence& to,
                                                       bool to_loops) {
  const double rate = view.sequence->fps * view.clock_rate;
  // The shown frame is as old as this.
  const double age_s = view.clock_s / view.clock_rate - static_cast<double>(view.k) / rate;
  motion::PlanOptions options;
  options.min_wait_s = lead_s_ + age_s;
  // A frame is shown at the first tick after it is due.
  options.max_latency_s = kMaxLatency_s - (view.now_s - asked_s_) - view.tick_s + age_s;
  const auto way = view.graph->plan({view.source, view.frame(), view.weights, rate}, run_.target, options);
  if (!way) return std::nullopt;
  const motion::Entry& entry = way->entry;
  run_.fade_frames = to_loops ? entry.fade_frames : std::clamp(to.frame_count - 1 - entry.frame, 1u, entry.fade_frames);
  run_.shift = entry.shift;
  run_.begin_k = view.k + way->wait_frames;
  const bool anew = run_.phase != Phase::Preparing || run_.entry_k != entry.frame;
  run_.phase = Phase::Preparing;
  run_.entry_k = entry.frame;
  if (anew) {
    run_.prepared_since_s = view.now_s;
    run_.measured = false;
  }
  const motion::GraphState& state = view.graph->states()[static_cast<size_t>(run_.target)];
  return Entrance{run_.entry_k, &state.weight_rows[entry.weight_row], anew};
}

bool Transitions::stepFade(double target_frames, bool new_picture) {
  const double passed = target_frames - static_cast<double>(run_.entry_k);
  if (!new_picture && passed < run_.fade_frames) return false;
  const float fade = motion::fadeWeight(passed, run_.fade_frames);
  if (fade == run_.fade) return false;
  run_.fade = fade;
  return true;
}

void Transitions::finish(int left, bool left_loops, bool entered_loops) {
  if (entered_loops)
    return_to_ = -1;
  else if (left_loops)
    return_to_ = left;
  run_ = {};
}

void Transitions::cancel(int current) {
  run_ = {};
  goal_ = current;
}

bool Transitions::returnDue(const TransitionView& view, const package::Sequence& to) const {
  const double rate = view.sequence->fps * view.clock_rate;
  const uint32_t frame = view.frame();
  const motion::Entry* entry = view.graph ? view.graph->entry(view.source, frame, 0, return_to_) : nullptr;
  double needed = 0;  // frames of the source
  if (entry) {
    const motion::GraphState& state = view.graph->states()[static_cast<size_t>(return_to_)];
    const double pass_s = motion::durationAt(to, state.weight_rows[entry->weight_row]);
    needed = (lead_s_ + kReturnChoice_s + entry->fade_frames * pass_s / to.frame_count) * rate;
  }
  return view.sequence->frame_count - 1 - frame <= needed;
}

}  // namespace fourdvt

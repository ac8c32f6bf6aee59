// SPDX-License-Identifier: Apache-2.0
// From one state to another: the graph says where to leave and to enter, a second track is prepared at the entry, and
// the two cross-fade (ALGORITHMS 4.8).
#include <algorithm>
#include <cmath>

#include "player/player_impl.h"

namespace fourdvt {

namespace {

constexpr double kMaxLatency_s = 0.4;     // from the request until the fade begins, if the target is prepared in time
constexpr double kReturnChoice_s = 0.12;  // room for a good exit before the end of a state that does not loop
constexpr double kPatience_s = 5;         // then the target is simply selected
constexpr double kMinLead_s = 0.05, kMaxLead_s = 2;

// The parameter values whose weights are nearest.
std::vector<double> parametersAt(const package::Sequence& sequence, const std::vector<float>& weights) {
  const package::ParameterSample* nearest = nullptr;
  float least = 1e30f;
  for (const package::ParameterSample& sample : sequence.space.samples) {
    float distance = 0;
    for (size_t m = 0; m < weights.size(); ++m) distance += std::abs(weights[m] - sample.weights[m]);
    if (distance >= least) continue;
    least = distance;
    nearest = &sample;
  }
  return nearest ? nearest->at : std::vector<double>{};
}

}  // namespace

std::string PlayerImpl::goal() const { return goal_ < 0 ? wanted_name_ : sequenceAt(goal_).name; }

Status PlayerImpl::goTo(const std::string& state) {
  const int target = findSequence(state);
  const bool by_graph =
      playing_ && hasFrame() && !character_->graph_uri.empty() && graph_state_ != stream::PartState::Failed;
  if (target < 0 || !by_graph) return selectSequence(state);
  if (sequences_[static_cast<size_t>(target)].broken)
    return Error{ErrorId::InvalidArgument, state + " cannot be played: its files are damaged"};
  if (target != goal_) asked_s_ = now_s_;
  if (transition_.phase == Phase::Fading) {
    goal_ = target;  // taken up when the fade is over
    return {};
  }
  if (transition_.phase == Phase::None || target != transition_.target) cancelTransition();
  goal_ = target;
  if (target != main().sequence && transition_.phase == Phase::None) beginTransition(target);
  return {};
}

void PlayerImpl::beginTransition(int target) {
  transition_ = {};
  transition_.phase = Phase::Wanted;
  transition_.target = target;
  transition_.wanted_since_s = now_s_;
  requestGraph();
  requestMissing();
}

void PlayerImpl::stepTransition() {
  if (transition_.phase == Phase::None) returnBeforeTheEnd();
  if (transition_.phase == Phase::Fading) stepFade();
  const bool held = !playing_ || main().seeking;
  if (held) asked_s_ = transition_.wanted_since_s = now_s_;
  if (held || (transition_.phase != Phase::Wanted && transition_.phase != Phase::Preparing)) return;
  if (graph_state_ == stream::PartState::Failed || now_s_ - transition_.wanted_since_s > kPatience_s) {
    selectInstead();
    return;
  }
  const SequenceState& target = sequences_[static_cast<size_t>(transition_.target)];
  if (!graph_ || target.header != stream::PartState::Present) return;
  if (transition_.phase == Phase::Wanted) {
    planTransition();
    return;
  }
  const bool prepared = !other().seeking;
  if (prepared && !transition_.measured) {
    transition_.measured = true;
    lead_s_ = std::clamp(1.25 * (now_s_ - transition_.prepared_since_s), kMinLead_s, kMaxLead_s);
  }
  const Track& source = main();
  const bool at_end = !looping(source) && frameOf(source, source.shown.k) + 1 == wantedOf(source).frame_count;
  if (source.shown.k < transition_.begin_k && !at_end) return;
  if (prepared) {
    startFade();
  } else if (at_end || source.shown.k > transition_.begin_k + 1) {  // too late
    lead_s_ = std::min(2 * lead_s_, kMaxLead_s);
    planTransition();
  }
}

void PlayerImpl::planTransition() {
  const Track& source = main();
  Track& target = other();
  const package::Sequence& to = sequenceAt(transition_.target);
  const double rate = wantedOf(source).fps * source.clock.rate();
  // The shown frame is as old as this.
  const double age_s = source.clock.position() / source.clock.rate() - static_cast<double>(source.shown.k) / rate;
  motion::PlanOptions options;
  options.min_wait_s = lead_s_ + age_s;
  // A frame is shown at the first tick after it is due.
  options.max_latency_s = kMaxLatency_s - (now_s_ - asked_s_) - tick_s_ + age_s;
  const auto plan = graph_->plan({source.sequence, frameOf(source, source.shown.k), source.weights.members, rate},
                                 transition_.target, options);
  if (!plan) {
    selectInstead();
    return;
  }
  const std::vector<float>& weights =
      graph_->states()[static_cast<size_t>(transition_.target)].weight_rows[plan->entry.weight_row];
  const int64_t start = plan->entry.frame;
  transition_.fade_frames = plan->entry.fade_frames;
  if (!looping(transition_.target))
    transition_.fade_frames = std::clamp(to.frame_count - 1 - plan->entry.frame, 1u, plan->entry.fade_frames);
  transition_.shift = plan->entry.shift;
  transition_.begin_k = source.shown.k + plan->wait_frames;
  const bool same = transition_.phase == Phase::Preparing && target.wanted_k == start;
  transition_.phase = Phase::Preparing;
  if (!same) {
    transition_.prepared_since_s = now_s_;
    transition_.measured = false;
    target.sequence = transition_.target;
    startAt(target, start);
  }
  target.entry_at = parametersAt(to, weights);
  if (target.seeking) return;
  enterParameters(target, transition_.target);
  target.stale = true;
}

void PlayerImpl::startFade() {
  transition_.phase = Phase::Fading;
  transition_.start_k = other().shown.k;
  other().stale = true;
  other().clock.setRunning(runs(other()));
  emit(EventKind::TransitionStarted);
  stepFade();
}

// With every picture of either motion: what is between them is not drawn.
void PlayerImpl::stepFade() {
  const double passed = other().clock.position() * wantedOf(other()).fps - static_cast<double>(transition_.start_k);
  if (!main().stale && !other().stale && passed < transition_.fade_frames) return;
  const float fade = motion::fadeWeight(passed, transition_.fade_frames);
  if (fade == transition_.fade) return;
  const motion::Placement source = sourcePlacement();
  transition_.fade = fade;
  if (travel_) setSourcePlacement(source);
  compose_ = true;
  if (fade >= 1) takeOver();
}

void PlayerImpl::takeOver() {
  if (looping(other()))
    return_to_ = -1;
  else if (looping(main()))
    return_to_ = main().sequence;
  transition_ = {};
  closeTrack(main());
  main_ = 1 - main_;
  starved_since_s_ = -1;
  emit(EventKind::SequenceChanged);
  emit(EventKind::TransitionEnded);
  if (goal_ != main().sequence) beginTransition(goal_);
}

// Whatever was on its way is given up; the source plays on.
void PlayerImpl::cancelTransition() {
  if (transition_.phase == Phase::None) return;
  const bool fading = transition_.phase == Phase::Fading;
  if (fading && travel_) placement_ = sourcePlacement();
  transition_ = {};
  closeTrack(other());
  goal_ = main().sequence;
  if (!fading) return;
  compose_ = true;
  emit(EventKind::TransitionEnded);
}

void PlayerImpl::selectInstead() {
  const int target = transition_.target, source = main().sequence;
  const bool source_loops = looping(main());
  cancelTransition();
  select(target);
  if (looping(main()))
    return_to_ = -1;
  else if (source_loops)
    return_to_ = source;
}

// A state that does not loop leads back to the one that it was entered from.
void PlayerImpl::returnBeforeTheEnd() {
  const Track& t = main();
  if (return_to_ < 0 || !playing_ || t.seeking || looping(t)) return;
  if (sequences_[static_cast<size_t>(return_to_)].broken) {
    return_to_ = -1;
    return;
  }
  const double rate = wantedOf(t).fps * t.clock.rate();
  const uint32_t frame = frameOf(t, t.shown.k);
  const motion::Entry* entry = graph_ ? graph_->entry(t.sequence, frame, 0, return_to_) : nullptr;
  // As late as leaves room for the choice and for the fade; else a cut, after its end.
  double needed = 0;
  if (entry) {
    const package::Sequence& to = sequenceAt(return_to_);
    const double pass_s =
        motion::durationAt(to, graph_->states()[static_cast<size_t>(return_to_)].weight_rows[entry->weight_row]);
    needed = (lead_s_ + kReturnChoice_s + entry->fade_frames * pass_s / to.frame_count) * rate;
  }
  if (wantedOf(t).frame_count - 1 - frame > needed) return;
  asked_s_ = now_s_;
  goal_ = return_to_;
  beginTransition(return_to_);
}

}  // namespace fourdvt

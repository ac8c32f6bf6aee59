// SPDX-License-Identifier: Apache-2.0
// From one state to another: the graph says where to leave and to enter, a second track is prepared at the entry, and
// the two cross-fade, centred on exit and entry (ALGORITHMS 4).
#include <algorithm>
#include <cmath>

#include "player/player_impl.h"

namespace fourdvt {

namespace {

constexpr double kMaxLatency_s = 0.4;     // until the fade begins, if the target is prepared in time
constexpr double kMinChoice_s = 0.08;     // exits are looked for over at least this long
constexpr double kReturnChoice_s = 0.12;  // the same at the end of a state that does not loop
constexpr int kFadeFrames = 10;           // of the target
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

float smoothstep(double x) { return static_cast<float>(x * x * (3 - 2 * x)); }

}  // namespace

std::string PlayerImpl::goal() const { return goal_ < 0 ? wanted_name_ : sequenceAt(goal_).name; }

Status PlayerImpl::goTo(const std::string& state) {
  const int target = findSequence(state);
  const bool by_graph =
      playing_ && hasFrame() && !character_->graph_uri.empty() && graph_state_ != stream::PartState::Failed;
  if (target < 0 || !by_graph) return selectSequence(state);
  if (sequences_[static_cast<size_t>(target)].broken)
    return Error{ErrorId::InvalidArgument, state + " cannot be played: its files are damaged"};
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
  if (transition_.phase != Phase::Wanted && transition_.phase != Phase::Preparing) return;
  if (!playing_ || main().seeking) {
    transition_.wanted_since_s = now_s_;
    return;
  }
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
  const package::Sequence& from = wantedOf(source);
  const package::Sequence& to = sequenceAt(transition_.target);
  const double source_rate = from.fps * source.clock.rate();
  const auto ahead = static_cast<int64_t>(std::ceil(lead_s_ * source_rate + 0.5 * kFadeFrames * from.fps / to.fps));
  const int64_t last = from.frame_count - 1, frame = frameOf(source, source.shown.k) + ahead;
  motion::PlanOptions options;
  options.max_latency_s =
      transition_.target == return_to_ ? kReturnChoice_s : std::max(kMaxLatency_s - lead_s_, kMinChoice_s);
  const auto plan =
      graph_->plan(source.sequence, static_cast<uint32_t>(looping(source) ? frame % (last + 1) : std::min(frame, last)),
                   source.weights.members, source_rate, transition_.target, options);
  if (!plan) {
    selectInstead();
    return;
  }
  const std::vector<float>& weights =
      graph_->states()[static_cast<size_t>(transition_.target)].weight_rows[plan->entry.weight_row];
  const double pass_s = to.isClass() ? motion::durationAt(to, weights) : to.duration_s();
  const double target_rate = rate_ * to.frame_count / pass_s;
  const int64_t entry = plan->entry.frame, count = to.frame_count;
  const bool wraps = looping(transition_.target);
  const int64_t before = wraps ? kFadeFrames / 2 : std::min<int64_t>(kFadeFrames / 2, entry);
  const int64_t start = (entry - before + count) % count;
  transition_.fade_frames =
      static_cast<int>(wraps ? kFadeFrames : std::clamp<int64_t>(count - 1 - start, 1, kFadeFrames));
  transition_.shift = plan->entry.shift;
  transition_.begin_k = source.shown.k + std::max<int64_t>(0, ahead + plan->wait_frames -
                                                                  std::llround(before * source_rate / target_rate));
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

void PlayerImpl::stepFade() {
  const double passed = static_cast<double>(other().shown.k - transition_.start_k + 1) / (transition_.fade_frames + 1);
  const float fade = smoothstep(std::min(passed, 1.0));
  if (fade == transition_.fade) return;
  const motion::Placement source = sourcePlacement();
  transition_.fade = fade;
  if (travel_) setSourcePlacement(source);
  compose_ = true;
  if (passed >= 1) takeOver();
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
  const bool planned = graph_ && graph_->entry(t.sequence, 0, 0, return_to_);  // else a cut, after its end
  const double needed = planned ? (lead_s_ + kReturnChoice_s) * rate + kFadeFrames : 0;
  if (wantedOf(t).frame_count - 1 - frameOf(t, t.shown.k) > needed) return;
  goal_ = return_to_;
  beginTransition(return_to_);
}

}  // namespace fourdvt

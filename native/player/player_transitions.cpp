// SPDX-License-Identifier: Apache-2.0
// Steps of a transition (parts/motion.h) in the player: a second track is prepared at the entry, and the two
// cross-fade.
#include "player/player_impl.h"

namespace fourdvt {

void PlayerImpl::goByGraph(int target) {
  loading_.revive(target);
  if (transitions_.ask(target, playback_.now_s())) return;
  if (target != transitions_.target()) cancelTransition();
  transitions_.setGoal(target);
  if (target != main().head.sequence() && !inPhase()) beginTransition(target);
}

TransitionView PlayerImpl::transitionView() const {
  const Playhead& head = main().head;
  const int target = transitions_.target();
  TransitionView view;
  view.now_s = playback_.now_s();
  view.tick_s = playback_.tick_s();
  view.held = !playback_.running() || head.seeking();
  view.source = head.sequence();
  view.sequence = &wantedOf(main());
  view.loops = loops(main());
  view.k = head.shown().k;
  view.clock_s = head.clock().position();
  view.clock_rate = head.clock().rate();
  view.weights = main().parameters.weights().members;
  view.graph = loading_.graph();
  view.graph_failed = loading_.graphFailed();
  view.target_has_header = target >= 0 && loading_.hasHeader(target);
  view.target_fetched = isReady(other()) && loading_.video(other().head.sequence(), other().feeding.gop());
  view.target_prepared = other().head.used() && !other().head.seeking();
  return view;
}

void PlayerImpl::beginTransition(int target) {
  transitions_.begin(target, playback_.now_s());
  loading_.requestGraph();
  requestMissing();
}

void PlayerImpl::stepTransition() {
  if (transitions_.phase() == Transitions::Phase::None) returnBeforeTheEnd();
  if (transitions_.fading()) stepFade();
  switch (transitions_.step(transitionView())) {
    case Transitions::Step::Nothing:
      break;
    case Transitions::Step::Plan:
      planTransition();
      break;
    case Transitions::Step::StartFade:
      startFade();
      break;
    case Transitions::Step::Select:
      selectInstead();
  }
}

void PlayerImpl::planTransition() {
  const int to = transitions_.target();
  const auto entrance = transitions_.plan(transitionView(), loading_.sequence(to), loops(to));
  if (!entrance) {
    selectInstead();
    return;
  }
  Track& target = other();
  if (entrance->anew) {
    target.head.select(to);
    startAt(target, entrance->frame);
  }
  target.parameters.setEntry(parametersAt(loading_.sequence(to), *entrance->weights));
  if (target.head.seeking()) return;
  target.parameters.enter(loading_.sequence(to), parameters_);
  target.frame.markStale();
}

void PlayerImpl::startFade() {
  transitions_.startFade();
  root_motion_.beginFade(transitions_.shift());
  other().frame.markStale();
  other().head.setRunning(runs(other()));
  outbox_.emit(EventKind::TransitionStarted);
  stepFade();
}

void PlayerImpl::stepFade() {
  const bool new_picture = main().frame.stale() || other().frame.stale();
  if (!transitions_.stepFade(other().head.clockFrames(wantedOf(other()).fps), new_picture)) return;
  root_motion_.setFade(transitions_.fade());
  composer_.markStale();
  if (transitions_.fade() >= 1) takeOver();
}

void PlayerImpl::takeOver() {
  transitions_.finish(main().head.sequence(), loops(main()), loops(other()));
  root_motion_.finishFade();
  closeTrack(main());
  main_ = 1 - main_;
  playback_.forgetStarvation();
  outbox_.emit(EventKind::SequenceChanged);
  outbox_.emit(EventKind::TransitionEnded);
  if (transitions_.goal() != main().head.sequence()) beginTransition(transitions_.goal());
}

// Discards the transition; the source plays on.
void PlayerImpl::cancelTransition() {
  if (!inPhase()) return;
  const bool fading = transitions_.fading();
  if (fading) root_motion_.cancelFade();
  transitions_.cancel(main().head.sequence());
  closeTrack(other());
  if (!fading) return;
  composer_.markStale();
  outbox_.emit(EventKind::TransitionEnded);
}

void PlayerImpl::selectInstead() {
  const int target = transitions_.target(), source = main().head.sequence();
  const bool source_loops = loops(source);
  cancelTransition();
  select(target);
  transitions_.finish(source, source_loops, loops(target));
}

// Returns from a state that does not loop to the state it was entered from.
void PlayerImpl::returnBeforeTheEnd() {
  const int back = transitions_.returnTo();
  if (back < 0 || !playback_.running() || seeking() || loops(main())) return;
  if (loading_.broken(back)) {
    transitions_.forgetReturn();
    return;
  }
  if (!transitions_.returnDue(transitionView(), loading_.sequence(back))) return;
  transitions_.askReturn(playback_.now_s());
  beginTransition(back);
}

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
// File requests, their answers, and broken sequences.
#include "base/later.h"
#include "player/player_impl.h"

namespace fourdvt {

namespace {
constexpr size_t kMaxLandings = 3;
constexpr double kLead_s = 0.12;  // typical preparation time of a transition's target
}  // namespace

void PlayerImpl::requestMissing() {
  if (!main().head.used()) return;
  std::array<Need, kDecoders + 1> needs;
  size_t count = 0;
  for (const Track* t : {&main(), &other()}) {
    if (!t->head.used()) continue;
    Need& need = needs[count++];
    need = {
        t->head.sequence(), frameOf(*t, t->head.position()), loops(*t), {}, !playback_.playing() && !t->head.seeking()};
    if (t->feeding.active() && !t->feeding.done()) need.fed_gop = t->feeding.gop();
  }
  if (starting()) needs[count++] = {0, 0, loops(0), {}, !playback_.playing()};
  const bool wanted = transitions_.phase() == Transitions::Phase::Wanted;
  loading_.requestMissing(std::span(needs.data(), count), wanted ? transitions_.target() : -1);
  if (looks_ahead_ && commanded_ && loading_.idle()) later<&PlayerImpl::fetchAhead>(*this);
}

void PlayerImpl::onRangeReceived(uint32_t id, std::span<const uint8_t> bytes) {
  Arrival arrival = loading_.receive(id, bytes);
  if (arrival.status.ok() && arrival.what == Arrival::What::Mesh)
    arrival.status = composer_.setMesh(device_, *character(), loading_.mesh());
  if (arrival.status.ok() && arrival.what == Arrival::What::Header) {
    for (Track& t : tracks_)
      if (t.head.sequence() == arrival.sequence) restartFeed(t);
  }
  settle(arrival);
}

void PlayerImpl::onRangeFailed(uint32_t id, const std::string& reason) { settle(loading_.refuse(id, reason)); }

void PlayerImpl::settle(const Arrival& arrival) {
  if (arrival.what == Arrival::What::LeftOut)
    outbox_.emit({EventKind::Warning, arrival.status.error(), 0, 0});
  else if (!arrival.status.ok())
    fail(arrival.status.error(), arrival.sequence);
  if (arrival.what != Arrival::What::Nothing) requestMissing();
}

// Reports a broken sequence, or everything (-1), and stops its requests. The player itself stays usable.
void PlayerImpl::fail(Error error, int broken_sequence) {
  if (broken_sequence >= 0 && broken_sequence == loading_.startSequence()) {  // the start file is dispensable
    if (starting()) select(0);
    return;
  }
  if (!loading_.markBroken(broken_sequence)) return;
  for (Track& t : tracks_)
    if (broken_sequence < 0 || broken_sequence == t.head.sequence()) stopFeed(t);
  if (broken_sequence < 0 || broken_sequence == transitions_.target()) giveUpTransition();
  outbox_.emit({EventKind::Error, std::move(error), 0, 0});
}

// Gives up a track whose pictures or labels exceed device memory: without the second track a transition is a cut.
void PlayerImpl::giveUp(const Track& t, const Error& error) {
  if (isMain(t))
    fail(error, -1);
  else
    later<&PlayerImpl::selectInstead>(*this);
}

void PlayerImpl::lookAhead(bool at_once) {
  looks_ahead_ = true;
  commanded_ = commanded_ || at_once;
  loading_.lookAhead();
}

// Prefetches for the sequences that follow the current one in the manifest.
void PlayerImpl::fetchAhead() {
  if (seeking() || transitions_.phase() != Transitions::Phase::None) return;
  std::array<Loading::Landing, kMaxLandings> landings;
  const int count = loading_.sequenceCount(), source = main().head.sequence();
  size_t found = 0;
  for (int i = 1; i < count && found < kMaxLandings; ++i) {
    const int target = (source + i) % count;
    if (!loading_.broken(target)) landings[found++] = {target, landingOn(target)};
  }
  loading_.fetchAhead({landings.data(), found});
}

// Target frame entered by a transition that starts now; without a motion graph, the first frame.
uint32_t PlayerImpl::landingOn(int target) const {
  const TransitionView view = transitionView();
  if (view.held || !view.graph) return 0;
  const auto way = view.graph->plan({view.source, view.frame(), view.weights, view.sequence->fps * view.clock_rate},
                                    target, {.min_wait_s = kLead_s});
  return way ? way->entry.frame : 0;
}

}  // namespace fourdvt

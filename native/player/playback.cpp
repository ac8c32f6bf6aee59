// SPDX-License-Identifier: Apache-2.0
// Clock, commands, the choice of the picture to show.
#include <algorithm>
#include <cmath>

#include "player/player_impl.h"

namespace fourdvt {

namespace {
constexpr double kStarvedBeforeWaiting_s = 0.25;
constexpr double kTimeUpdatePeriod_s = 0.25;
constexpr double kMaxStep_s = 0.25;  // a sleeping tab
}  // namespace

Result<std::unique_ptr<Player>> Player::create(gpu::Device& device, const PlayerOptions& options) {
  auto recipe = render::Recipe::create(device);
  if (!recipe.ok()) return recipe.error();
  return create(device, recipe.take(), options);
}

Result<std::unique_ptr<Player>> Player::create(gpu::Device& device, std::shared_ptr<render::Recipe> recipe,
                                               const PlayerOptions& options) {
  if (options.picture_slots < 2) return Error{ErrorId::InvalidArgument, "picture_slots must be at least 2"};
  return std::unique_ptr<Player>(new PlayerImpl(device, options, std::move(recipe)));
}

PlayerImpl::PlayerImpl(gpu::Device& device, const PlayerOptions& options, std::shared_ptr<render::Recipe> recipe)
    : device_(device), options_(options), recipe_(std::move(recipe)), cache_(options.encoded_budget_bytes) {
  for (int i = 0; i < kDecoders; ++i) {
    tracks_[static_cast<size_t>(i)].decoder = i;
    tracks_[static_cast<size_t>(i)].slots.resize(static_cast<size_t>(options.picture_slots));
  }
}

bool PlayerImpl::looping(int sequence) const {
  return loop_override_ < 0 ? sequenceAt(sequence).loop : loop_override_ == 1;
}

bool PlayerImpl::runs(const Track& t) const {
  return playing_ && !t.seeking && (&t == &main() || transition_.phase == Phase::Fading);
}

uint32_t PlayerImpl::frameOf(const Track& t, int64_t k) const {
  return static_cast<uint32_t>(k % wantedOf(t).frame_count);
}

// What must be at hand next.
int64_t PlayerImpl::positionOf(const Track& t) const { return t.seeking ? t.wanted_k : t.shown.k; }

void PlayerImpl::startAt(Track& t, int64_t frame) {
  t.wanted_k = frame;
  t.seeking = true;
  t.ended = false;
  t.entry_at.clear();
  if (&t == &main()) starved_since_s_ = -1;
  t.clock.jump(static_cast<double>(frame) / wantedOf(t).fps);
  t.clock.setRunning(false);
  stopFeed(t);
  if (stateOf(t).header == stream::PartState::Present && !stateOf(t).broken) restartFeed(t);
  requestMissing();
}

void PlayerImpl::play() {
  if (playing_) return;
  playing_ = true;
  if (!main().used()) return;
  if (main().ended) startAt(main(), 0);
  for (Track& t : tracks_) t.clock.setRunning(runs(t));
  if (!main().seeking) emit(EventKind::Playing);
}

void PlayerImpl::pause() {
  if (!playing_) return;
  playing_ = waiting_ = false;
  for (Track& t : tracks_) t.clock.setRunning(false);
  emit(EventKind::Paused);
}

void PlayerImpl::seekFrame(uint32_t frame) {
  if (!main().used()) return;
  cancelTransition();
  seek_requested_ = true;
  startAt(main(), std::min(frame, wantedOf(main()).frame_count - 1));
}

void PlayerImpl::seek(double time_s) {
  if (!main().used() || !std::isfinite(time_s)) return;
  const package::Sequence& sequence = wantedOf(main());
  seekFrame(static_cast<uint32_t>(
      std::clamp(time_s * sequence.fps + 1e-6, 0.0, static_cast<double>(sequence.frame_count - 1))));
}

int PlayerImpl::findSequence(const std::string& name) const {
  for (size_t i = 0; i < sequences_.size(); ++i)
    if (sequenceAt(static_cast<int>(i)).name == name) return static_cast<int>(i);
  return -1;
}

Status PlayerImpl::selectSequence(const std::string& name) {
  wanted_name_ = name;
  if (!character_) return {};
  const int sequence = findSequence(name);
  if (sequence < 0) return Error{ErrorId::InvalidArgument, "the character has no sequence named " + name};
  cancelTransition();
  return_to_ = -1;
  goal_ = sequence;
  if (sequence != main().sequence) select(sequence);
  return {};
}

void PlayerImpl::select(int sequence) {
  goal_ = sequence;
  main().sequence = sequence;
  startAt(main(), 0);
}

void PlayerImpl::setRate(double rate) {
  if (rate > 0) rate_ = std::min(rate, 4.0);
}

void PlayerImpl::setLoop(int loop) {
  loop_override_ = std::clamp(loop, -1, 1);
  for (Track& t : tracks_) {
    if (!ready(t) || !t.feeding || !t.feed_done || !looping(t) || t.shown.slot < 0 || t.seeking) continue;
    t.wanted_k = t.shown.k;
    restartFeed(t);
    t.seeking = true;
    t.clock.setRunning(false);
  }
}

void PlayerImpl::tick(double now_s) {
  tick_s_ = ticked_ ? std::clamp(now_s - now_s_, 0.0, kMaxStep_s) : 0;
  ticked_ = true;
  now_s_ = now_s;
  for (Track& t : tracks_) {
    t.clock.setRate(clockRate(t));
    t.clock.advance(now_s, kMaxStep_s);
  }
  if (!main().used()) return;
  glideParameters(tick_s_);
  turn(tick_s_);
  requestMissing();
  for (Track* t : {&main(), &other()})
    if (ready(*t)) choosePicture(*t);
  stepTransition();
  composeMesh();
  if (playing_ && !main().seeking && now_s - last_timeupdate_s_ >= kTimeUpdatePeriod_s) {
    last_timeupdate_s_ = now_s;
    emit(EventKind::TimeUpdate);
  }
}

// The newest ready picture up to `newest_k` that is newer than the shown one; while seeking only the wanted one.
static int pictureFor(const Track& t, int64_t newest_k) {
  int best = -1;
  for (size_t i = 0; i < t.slots.size(); ++i) {
    const Slot& slot = t.slots[i];
    if (slot.state != Slot::State::Ready || slot.epoch != t.epoch || static_cast<int>(i) == t.shown.slot) continue;
    const bool fits = t.seeking ? slot.k == t.wanted_k : slot.k <= newest_k && slot.k > t.shown.k;
    if (fits && (best < 0 || slot.k > t.slots[static_cast<size_t>(best)].k)) best = static_cast<int>(i);
  }
  return best;
}

void PlayerImpl::choosePicture(Track& t) {
  if (!t.seeking && !runs(t)) return;
  const double fps = wantedOf(t).fps;
  const auto clock_k = static_cast<int64_t>(std::floor(t.clock.position() * fps + 1e-6));
  const int slot = pictureFor(t, clock_k);
  if (slot >= 0 && geometryOf(t.sequence, frameOf(t, t.slots[static_cast<size_t>(slot)].k))) {
    const int previous_sequence = t.shown.sequence;
    if (!t.seeking) stats_.frames_late += static_cast<uint64_t>(t.slots[static_cast<size_t>(slot)].k - t.shown.k - 1);
    if (!present(t, slot)) return;
    if (&t == &main()) noteStarvation(false);
    if (t.seeking) finishSeek(t, previous_sequence);
  } else if (runs(t) && &t == &main()) {
    noteStarvation(clock_k > t.shown.k && !t.feed_done);
  }
  if (!runs(t)) return;
  int64_t newest_k = t.shown.k;
  for (const Slot& s : t.slots)
    if (s.state == Slot::State::Ready && s.epoch == t.epoch) newest_k = std::max(newest_k, s.k);
  t.clock.holdAt(static_cast<double>(newest_k + 1) / fps);
  if (&t == &main()) finishAtEnd(t);
}

// A state that is about to lead on stays on its last frame instead of ending.
void PlayerImpl::finishAtEnd(Track& t) {
  if (looping(t) || frameOf(t, t.shown.k) + 1 != wantedOf(t).frame_count) return;
  if (transition_.phase != Phase::None || return_to_ >= 0) return;
  if (t.clock.position() * wantedOf(t).fps < static_cast<double>(t.shown.k + 1) - 1e-6) return;
  playing_ = false;
  t.ended = true;
  t.clock.setRunning(false);
  emit(EventKind::Ended);
}

void PlayerImpl::finishSeek(Track& t, int previous_sequence) {
  t.seeking = false;
  t.clock.jump(static_cast<double>(t.shown.k) / wantedOf(t).fps);
  t.clock.setRunning(runs(t));
  if (&t != &main()) return;
  if (!can_play_) {
    can_play_ = true;
    emit(EventKind::CanPlay);
  }
  if (previous_sequence >= 0 && previous_sequence != t.shown.sequence) emit(EventKind::SequenceChanged);
  if (seek_requested_) emit(EventKind::Seeked);
  seek_requested_ = false;
  if (playing_) emit(EventKind::Playing);
}

void PlayerImpl::noteStarvation(bool starved) {
  if (!starved) {
    starved_since_s_ = -1;
    if (waiting_ && playing_) emit(EventKind::Playing);
    waiting_ = false;
    return;
  }
  if (starved_since_s_ < 0) starved_since_s_ = now_s_;
  if (!waiting_ && now_s_ - starved_since_s_ > kStarvedBeforeWaiting_s) {
    waiting_ = true;
    emit(EventKind::Waiting);
  }
}

const package::Sequence* PlayerImpl::sequence() const { return main().used() ? &wantedOf(main()) : nullptr; }

uint32_t PlayerImpl::frame() const {
  const Track& t = main();
  if (!t.used()) return 0;
  if (t.shown.slot < 0) return frameOf(t, t.wanted_k);
  return static_cast<uint32_t>(t.shown.k % sequenceAt(t.shown.sequence).frame_count);
}

double PlayerImpl::currentTime() const {
  const Track& t = main();
  if (!t.used()) return 0;
  return frameOf(t, t.seeking || t.shown.slot < 0 ? t.wanted_k : t.shown.k) / wantedOf(t).fps;
}

PlayerStats PlayerImpl::stats() const {
  PlayerStats stats = stats_;
  stats.encoded_bytes_held = cache_.encodedBytes();
  return stats;
}

bool PlayerImpl::nextEvent(Event& out) {
  if (events_.empty()) return false;
  out = std::move(events_.front());
  events_.pop_front();
  return true;
}

}  // namespace fourdvt

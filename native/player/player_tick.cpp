// SPDX-License-Identifier: Apache-2.0
// Tick: advances the clock and selects a picture.
#include <algorithm>
#include <array>

#include "base/later.h"
#include "player/player_impl.h"

namespace fourdvt {

void PlayerImpl::tick(double now_s) {
  playback_.tick(now_s);
  loading_.tick(playback_.tick_s());
  checks_.settle([this](int slot, std::optional<uint32_t> seen) { settlePicture(slot, seen); });
  // Time between pictures, if every tick is drawn; web/src/session/drawing.ts does so for methods with temporal state.
  method_.elapsed_s = static_cast<float>(playback_.tick_s());
  for (Track& t : tracks_) t.head.advance(now_s, clockRate(t), kMaxStep_s);
  if (!main().head.used()) return;
  glideParameters(playback_.tick_s());
  if (playback_.running() && !seeking()) root_motion_.turn(playback_.tick_s());
  requestMissing();
  if (loading_.slicing()) later<&PlayerImpl::decodeAhead>(*this);
  for (Track* t : {&main(), &other()})
    if (isReady(*t)) choosePicture(*t);
  // Counts a requested motion that is late as starvation, like a late picture.
  if (playback_.playing() && hasFrame() && seeking()) playback_.noteStarvation(playback_.canPlay());
  if (inPhase() || transitions_.returnTo() >= 0) later<&PlayerImpl::stepTransition>(*this);
  if (!playback_.playing()) sharpen();
  composeMesh();
  stagePictures();
  playback_.finishTick(seeking());
}

// Rate of a class's phases: one pass per duration at these weights.
double PlayerImpl::clockRate(const Track& t) const {
  const double rate = playback_.rate();
  if (!t.head.used() || t.head.shown().sequence != t.head.sequence()) return rate;
  const package::Sequence& sequence = wantedOf(t);
  const double duration_s = motion::durationAt(sequence, t.parameters.weights().members);
  return sequence.isClass() && duration_s > 0 ? rate * sequence.duration_s() / duration_s : rate;
}

// Next best ready picture after `slot`; -1: none. While playing, an older one; while seeking, the GOP's key.
int PlayerImpl::nextChoice(const Track& t, int slot) const {
  if (t.head.seeking()) {
    const int key = t.slots.findReady(t.feeding.previewK());
    return key == slot ? -1 : key;
  }
  return slot < 0 ? -1 : t.slots.newestReady(t.head.shown().k + 1, t.slots.k(slot) - 1);
}

void PlayerImpl::choosePicture(Track& t) {
  if (!t.head.seeking() && !runs(t)) return;
  const double fps = wantedOf(t).fps;
  int slot = t.head.choose(t.slots, fps);
  const bool ready = slot >= 0;
  FrameGeometry geometry;
  for (slot = ready ? slot : nextChoice(t, slot); slot >= 0; slot = nextChoice(t, slot)) {
    geometry = geometryOf(t.head.sequence(), frameOf(t, t.slots.k(slot)), !t.head.seeking());
    if (geometry) break;
  }
  if (geometry) {
    if (!showPicture(t, slot, geometry)) return;
  } else if (runs(t) && isMain(t)) {
    playback_.noteStarvation(t.head.isLate(fps) && !t.feeding.done());
  }
  if (!runs(t)) return;
  if (isMain(t) && !other().head.used()) measureDecoding(t, !ready && t.head.isLate(fps));
  t.head.holdAtNewest(t.slots, fps);
  if (isMain(t)) finishAtEnd(t);
}

// Excludes waits for the network: the next samples to feed must be loaded, too.
void PlayerImpl::measureDecoding(const Track& t, bool late) {
  late = late && t.feeding.decoding() && loading_.video(t.head.sequence(), t.feeding.gop());
  loading_.ladder().measureDecoding(t.feeding.rendition(), playback_.tick_s(), late);
}

// False: out of memory.
bool PlayerImpl::showPicture(Track& t, int slot, const FrameGeometry& geometry) {
  const int previous_sequence = t.head.shown().sequence;
  const int64_t k = t.slots.k(slot);
  if (!t.head.seeking()) stats_.frames_late += static_cast<uint64_t>(k - t.head.shown().k - 1);
  if (!present(t, slot, geometry)) return false;
  t.slots.show(slot);
  t.head.show(slot, k);
  ++stats_.frames_shown;
  if (isMain(t) && !t.head.seeking()) playback_.noteStarvation(false);
  if (t.head.seeking() && k == t.head.wantedK()) finishSeek(t, previous_sequence);
  return true;
}

// Shows picture, labels and alignment of one presentation together; composeMesh adds its mesh. Moves the character
// along if the presentation continues the shown motion.
bool PlayerImpl::present(Track& t, int slot, const FrameGeometry& geometry) {
  const package::Sequence& sequence = wantedOf(t);
  const int64_t k = t.slots.k(slot);
  Status status = t.frame.present(device_, composer_.model(), *character(), sequence,
                                  renditionOf(t, t.slots.rendition(slot)), geometry);
  if (!status.ok()) {
    giveUp(t, status.error());
    return false;
  }
  const Presentation& shown = t.head.shown();
  if (shown.sequence != t.head.sequence() || t.parameters.hasEntry()) t.parameters.enter(sequence, parameters_);
  if (geometry.surfaces) return true;  // no root motion: fixed in capture space
  const RootFrame root{sequence, t.parameters.weights().members, geometry};
  const int64_t count = sequence.frame_count;
  if (!t.head.seeking())
    t.roots.lead(root_motion_, isMain(t) ? RootMotion::Side::Source : RootMotion::Side::Target, root,
                 k / count - shown.k / count);
  t.roots.keep(root);
  return true;
}

void PlayerImpl::finishSeek(Track& t, int previous_sequence) {
  t.head.finishSeek(wantedOf(t).fps);
  t.head.setRunning(runs(t));
  if (!isMain(t)) return;
  if (starting()) return select(0);
  loading_.onFirstPicture();
  const bool known = previous_sequence >= 0 && previous_sequence != loading_.startSequence();
  playback_.finishSeek(known && previous_sequence != t.head.sequence());
}

// Ends playback, except in a state about to lead on, which stays on its last frame.
void PlayerImpl::finishAtEnd(Track& t) {
  if (loops(t) || shownFrameOf(t) + 1 != wantedOf(t).frame_count) return;
  if (inPhase() || transitions_.returnTo() >= 0) return;
  if (!t.head.pastShown(wantedOf(t).fps)) return;
  t.head.end();
  playback_.end();
}

// Empty while not decoded, or broken. due: as in Loading::geometry.
FrameGeometry PlayerImpl::geometryOf(int sequence, uint32_t frame, bool due) {
  FrameGeometry geometry;
  if (Status status = loading_.geometry(sequence, frame, due, geometry); !status.ok()) fail(status.error(), sequence);
  return geometry;
}

// Replaces a standing picture, and that of the start file, once its GOP is loaded in a higher rendition. The edge may
// cross-fade: the picture on screen stays until after Sharper is emitted.
void PlayerImpl::sharpen() {
  Track& t = main();
  if (!in_sight_ || inPhase() || other().head.used() || !isReady(t)) return;
  const bool started = hasFrame() && t.head.shown().sequence == loading_.startSequence() && !starting();
  if (started && t.head.wantedK() == 0 && !start_fades_ && loading_.video(0, 0) && loading_.renditionOf(0, 0) > 0) {
    start_fades_ = true;
    outbox_.emit(EventKind::Sharper);
  }
  if (seeking()) return;
  const uint32_t gop = loading_.index(t.head.sequence()).chunkOfFrame(shownFrameOf(t));
  if (!loading_.takeSharper(t.head.sequence(), gop, t.slots.rendition(t.head.shown().slot))) return;
  outbox_.emit(EventKind::Sharper);
  t.head.seekShown();
  restartFeed(t);
}

void PlayerImpl::decodeAhead() {
  std::array<Need, kDecoders> needs;
  size_t count = 0;
  for (const Track* t : {&main(), &other()})
    if (isReady(*t)) needs[count++] = {t->head.sequence(), frameOf(*t, t->head.position()), loops(*t), {}};
  loading_.decodeAhead({needs.data(), count}, seeking());
}

}  // namespace fourdvt

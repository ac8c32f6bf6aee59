// SPDX-License-Identifier: Apache-2.0
// What passes between the player and its edge: requests, answers to fetches, decoded pictures, failures.
#include <cstdlib>

#include "base/later.h"
#include "package/barcode.h"
#include "player/player_impl.h"

namespace fourdvt {

namespace {
// Answers of acquireSlot.
constexpr int kNoSlotNow = -1, kNotAwaited = -2;
constexpr int kMostMisfits = 8;
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

// Reports what is broken and stops asking for it: one sequence, or everything (-1). The player itself stays usable.
void PlayerImpl::fail(Error error, int broken_sequence) {
  if (broken_sequence >= 0 && broken_sequence == loading_.startSequence()) {  // all can do without
    if (starting()) select(0);
    return;
  }
  if (!loading_.markBroken(broken_sequence)) return;
  for (Track& t : tracks_)
    if (broken_sequence < 0 || broken_sequence == t.head.sequence()) stopFeed(t);
  if (broken_sequence < 0 || broken_sequence == transitions_.target()) giveUpTransition();
  outbox_.emit({EventKind::Error, std::move(error), 0, 0});
}

// The device has no memory for a track's pictures or labels: without the second track a transition is a cut.
void PlayerImpl::giveUp(const Track& t, const Error& error) {
  if (isMain(t))
    fail(error, -1);
  else
    later<&PlayerImpl::selectInstead>(*this);
}

FedSequence PlayerImpl::fedBy(const Track& t) const {
  const int sequence = t.head.sequence();
  return {sequence, &loading_.sequence(sequence), &loading_.index(sequence), loops(sequence),
          loading_.renditionOf(sequence, t.feeding.gop())};
}

void PlayerImpl::stopFeed(Track& t) {
  t.feeding.stop();
  t.slots.beginEpoch();
}

// The key of the sought frame's GOP is nearer to it than what is shown of the sequence.
bool PlayerImpl::previews(const Track& t) const {
  if (!options_.preview_seeks || options_.paced || !isMain(t) || !t.head.seeking() ||
      t.head.shown().sequence != t.head.sequence())
    return false;
  const package::StreamIndex& index = loading_.index(t.head.sequence());
  const int64_t wanted = frameOf(t, t.head.wantedK()),
                key = index.chunks[index.chunkOfFrame(uint32_t(wanted))].first_frame;
  return std::abs(shownFrameOf(t) - wanted) > wanted - key;
}

void PlayerImpl::restartFeed(Track& t) {
  stopFeed(t);
  t.feeding.restart(fedBy(t), t.head.wantedK(), outbox_, previews(t));
}

// Goes on without its decoder's pictures: what is on screen stays. A pause waits for `play`, so that a decoder that is
// not needed is not taken away again.
void PlayerImpl::feedAgain(Track& t) {
  if (!t.feeding.lost() || !isReady(t)) return;
  if (t.head.seeking() || !t.head.hasPicture()) return restartFeed(t);
  if (!playback_.playing()) return;
  const int64_t next = t.head.shown().k + 1;
  if (!loops(t) && next >= wantedOf(t).frame_count) return;
  stopFeed(t);
  t.feeding.restart(fedBy(t), next, outbox_);
}

// Frees decoder and pictures; pictures that are being filled go when they are committed.
void PlayerImpl::closeTrack(Track& t) {
  if (!t.head.used()) return;
  stopFeed(t);
  t.slots.close();
  t.feeding.close(outbox_);
  t.head.close();
  t.frame.release();
}

bool PlayerImpl::nextRequest(Request& out) {
  if (outbox_.nextRequest(out)) return true;
  if (!in_sight_) return false;
  for (Track* t : {&main(), &other()}) {
    if (!isReady(*t)) continue;
    if (!t->feeding.begun()) loading_.takeBetter(t->head.sequence(), t->feeding.gop());
    const std::vector<uint8_t>* video = loading_.video(t->head.sequence(), t->feeding.gop());
    if (t->feeding.next(fedBy(*t), video, t->slots.freeCount(), out)) return true;
  }
  for (Track& t : tracks_) t.feeding.noteIdlePoll(t.slots.usedCount());
  return false;
}

// Null for a number that is none. Slots are numbered over both decoders; `slot` becomes the number within the track.
Track* PlayerImpl::trackOf(int& slot) {
  const int each = options_.picture_slots;
  if (slot < 0 || slot >= kDecoders * each) return nullptr;
  Track& track = tracks_[static_cast<size_t>(slot / each)];
  slot %= each;
  return &track;
}

int PlayerImpl::acquireSlot(int decoder, int64_t timestamp_us) {
  if (decoder < 0 || decoder >= kDecoders) return kNotAwaited;
  Track& t = tracks_[static_cast<size_t>(decoder)];
  const std::optional<int64_t> k = t.feeding.presentationOf(timestamp_us);
  if (!k) return kNotAwaited;
  const int slot = t.slots.findFree();
  if (slot < 0) return kNoSlotNow;
  t.feeding.take(timestamp_us);
  if (Status status = t.slots.prepare(device_, slot, renditionOf(t, t.feeding.rendition())); !status.ok()) {
    giveUp(t, status.error());
    return kNotAwaited;
  }
  t.slots.fill(slot, *k, t.feeding.rendition());
  return decoder * options_.picture_slots + slot;
}

void PlayerImpl::uploadI420(int slot, const I420View& picture, PictureBytes bytes) {
  Track* t = trackOf(slot);
  if (!t || !t->slots.awaits(slot)) return;
  const package::Rendition& rendition = renditionOf(*t, t->slots.rendition(slot));
  if (!checkSize(*t, slot, picture.width, picture.height)) return;
  if (checkNumber(*t, slot, package::readBarcode(rendition.barcode, picture)))
    t->slots.hold(slot, picture, std::move(bytes));
}

bool PlayerImpl::checkSize(Track& t, int slot, int width, int height) {
  const package::Rendition& rendition = renditionOf(t, t.slots.rendition(slot));
  if (width == rendition.width && height == rendition.height) return true;
  t.slots.reject(slot);
  fail({ErrorId::VideoInvalid, rendition.video_uri + ": pictures are " + std::to_string(width) + "x" +
                                   std::to_string(height) + ", the manifest says " + std::to_string(rendition.width) +
                                   "x" + std::to_string(rendition.height)},
       t.head.sequence());
  return false;
}

// Judges the picture in a slot by the frame number that its barcode has.
bool PlayerImpl::checkNumber(Track& t, int slot, std::optional<uint32_t> seen) {
  const int64_t k = t.slots.k(slot);
  const uint32_t expected = frameOf(t, k) % 4096;
  ++stats_.barcode_checked;
  if (seen == expected) {
    misfits_ = 0;
    return true;
  }
  if (options_.paced) return later<&PlayerImpl::takeAs>(*this, t, slot, seen);
  ++stats_.barcode_mismatches;
  t.slots.reject(slot);
  const bool sought = t.head.seeking() && k == t.head.wantedK();
  if (!sought && ++misfits_ < kMostMisfits) return false;
  misfits_ = 0;
  fail({ErrorId::VideoInvalid, renditionOf(t, t.slots.rendition(slot)).video_uri + ": frame " +
                                   std::to_string(expected) + " carries another frame's barcode; the file is damaged"},
       t.head.sequence());
  return false;
}

void PlayerImpl::settlePicture(int slot, std::optional<uint32_t> seen) {
  Track* t = trackOf(slot);
  if (t->slots.awaits(slot)) checkNumber(*t, slot, seen);
  t->slots.commit(slot, t->head.used());
}

gpu::TextureId PlayerImpl::slotTexture(int slot) const {
  const Track* t = const_cast<PlayerImpl*>(this)->trackOf(slot);
  return t ? t->slots.picture(slot).rgba.id() : 0;
}

void PlayerImpl::commitSlot(int slot, int width, int height) {
  const int number = slot;
  Track* t = trackOf(slot);
  if (!t) return;
  const bool unread = options_.picture_kind == render::PictureTextures::Kind::Rgba && t->slots.awaits(slot);
  if (unread && checkSize(*t, slot, width, height) && options_.readable) {
    const package::BarcodeStrip& strip = renditionOf(*t, t->slots.rendition(slot)).barcode;
    const Status begun = checks_.begin(number, t->slots.picture(slot).rgba.id(), strip);
    if (begun.ok()) return;  // settled by a tick
    giveUp(*t, begun.error());
  }
  t->slots.commit(slot, t->head.used());
}

void PlayerImpl::onDecoderFailed(int decoder, DecoderFault fault, const std::string& reason) {
  if (decoder < 0 || decoder >= kDecoders) return;
  Track& t = tracks_[static_cast<size_t>(decoder)];
  if (!t.head.used()) return;
  stopFeed(t);
  t.feeding.loseDecoder(fault);
  const uint32_t rendition = t.feeding.rendition();
  if (isMain(t) && starting()) {
    if (fault == DecoderFault::Unsupported) loading_.ladder().leaveOut(loading_.sequence(0), rendition);
    return select(0);
  }
  if (fault != DecoderFault::Unsupported && !t.feeding.hopeless()) return feedAgain(t);
  if (fault == DecoderFault::Unsupported && loading_.ladder().leaveOut(wantedOf(t), rendition)) {
    loading_.dropOtherRenditions();
    return feedAgain(t);
  }
  if (!isMain(t)) {
    outbox_.request(CloseDecoder{decoder});
    later<&PlayerImpl::selectInstead>(*this);
    return;
  }
  constexpr ErrorId kIds[] = {ErrorId::VideoInvalid, ErrorId::DecoderUnsupported, ErrorId::DecoderLost};
  fail({kIds[static_cast<size_t>(fault)],
        renditionOf(t, rendition).video_uri + ": the video does not decode (" + reason + ")"},
       t.head.sequence());
}

void PlayerImpl::setInSight(bool in_sight) {
  in_sight_ = in_sight;
  for (Track& t : tracks_) {
    if (!t.head.used()) continue;
    if (in_sight) {
      feedAgain(t);
    } else {
      stopFeed(t);
      t.feeding.close(outbox_);
    }
  }
}

}  // namespace fourdvt

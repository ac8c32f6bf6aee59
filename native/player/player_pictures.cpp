// SPDX-License-Identifier: Apache-2.0
// Decoder input, and returned pictures.
#include <cstdlib>

#include "base/later.h"
#include "package/barcode.h"
#include "player/player_impl.h"

namespace fourdvt {

namespace {
// Results of acquireSlot.
constexpr int kNoSlotNow = -1, kNotAwaited = -2;
constexpr int kMaxMisfits = 8;
}  // namespace

FedSequence PlayerImpl::fedBy(const Track& t) const {
  const int sequence = t.head.sequence();
  return {sequence, &loading_.sequence(sequence), &loading_.index(sequence), loops(sequence),
          loading_.renditionOf(sequence, t.feeding.gop())};
}

void PlayerImpl::stopFeed(Track& t) {
  t.feeding.stop();
  t.slots.beginEpoch();
}

// True if the key of the sought frame's GOP is nearer to it than the shown frame of the sequence.
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

// Restarts after a lost decoder; the picture on screen stays. While paused the restart waits for `play`, so that an
// idle decoder is not reclaimed again.
void PlayerImpl::feedAgain(Track& t) {
  if (!t.feeding.lost() || !isReady(t)) return;
  if (t.head.seeking() || !t.head.hasPicture()) return restartFeed(t);
  if (!playback_.playing()) return;
  const int64_t next = t.head.shown().k + 1;
  if (!loops(t) && next >= wantedOf(t).frame_count) return;
  stopFeed(t);
  t.feeding.restart(fedBy(t), next, outbox_);
}

// Frees decoder and pictures; pictures being filled are freed by commit.
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

// Returns a slot's track; null for an invalid number. Slots are numbered over both decoders; `slot` becomes the number
// within the track.
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

// Checks the picture in a slot by its barcode's frame number.
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
  if (!sought && ++misfits_ < kMaxMisfits) return false;
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
    if (begun.ok()) return;  // completed by a tick
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

// Keeps one or two pictures ready: slows down a decoder ahead of the clock, speeds up one behind.
double PlayerImpl::pace(int decoder) const {
  const Track& t = tracks_[static_cast<size_t>(decoder != 0)];
  if (!t.head.used() || !runs(t)) return 0;
  constexpr double kPaces[] = {1.15, 1, 0.9};
  const int ready = std::min(t.slots.readyCount(), 2);
  return wantedOf(t).fps * clockRate(t) * kPaces[ready];
}

// Handles a picture whose barcode differs from its timestamp: the element had advanced before the copy. It is
// renumbered to a neighbouring presentation that is yet to be shown, and dropped if that has passed. A seek requires
// the exact picture, which is awaited again.
bool PlayerImpl::takeAs(Track& t, int slot, std::optional<uint32_t> seen) {
  const int64_t named = t.slots.k(slot);
  if (t.head.seeking()) {
    t.slots.reject(slot);
    t.feeding.awaitAgain(named);
    return false;
  }
  // Search window: a late page copies a later picture, an early timestamp belongs to a picture still to come. The frame
  // number is unambiguous within less than a loop.
  constexpr int64_t kBack = 8, kOn = 17;
  const int64_t first = std::max<int64_t>(0, named - kBack);
  const int64_t end = std::min(named + kOn, first + wantedOf(t).frame_count);
  for (int64_t k = first; seen && k < end; ++k) {
    if (frameOf(t, k) % 4096 != *seen) continue;
    if (k > t.head.shown().k)
      t.slots.renumber(slot, k);
    else
      t.slots.reject(slot);
    return k > t.head.shown().k;
  }
  ++stats_.barcode_mismatches;
  t.slots.reject(slot);
  return false;
}

}  // namespace fourdvt

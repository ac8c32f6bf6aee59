// SPDX-License-Identifier: Apache-2.0
// Decoding: samples go out when the edge polls, in decoding order, from a GOP's key sample on; decoded pictures come
// back by timestamp into slots.
#include <algorithm>

#include "package/barcode.h"
#include "player/player_impl.h"

namespace fourdvt {

namespace {
constexpr size_t kMaxReorderAllowance = 32;
constexpr int64_t kTimestampStep_us = 40000;  // names a presentation, whatever the sequence's frame rate

size_t usedSlots(const Track& track) {
  return static_cast<size_t>(std::count_if(track.slots.begin(), track.slots.end(),
                                           [](const Slot& s) { return s.state != Slot::State::Free; }));
}

void release(Slot& slot) {
  slot.picture = {};
  slot.width = slot.height = 0;
}
}  // namespace

void PlayerImpl::stopFeed(Track& t) {
  t.feeding = false;
  t.in_flight.clear();
  ++t.epoch;
  for (size_t i = 0; i < t.slots.size(); ++i)
    if (t.slots[i].state == Slot::State::Ready && static_cast<int>(i) != t.shown.slot)
      t.slots[i].state = Slot::State::Free;
}

// Starts decoding at the GOP that holds the wanted presentation.
void PlayerImpl::restartFeed(Track& t) {
  stopFeed(t);
  const package::StreamIndex& index = stateOf(t).index;
  const uint32_t frame = frameOf(t, t.wanted_k);
  t.feed_gop = index.chunkOfFrame(frame);
  t.feed_gop_k = t.wanted_k - (frame - index.chunks[t.feed_gop].first_frame);
  t.feed_sample = 0;
  t.drop_before_k = t.wanted_k;
  t.serial_base = t.next_serial - t.feed_gop_k;  // timestamps never repeat, whatever is sought
  t.feed_done = t.flushed = false;
  t.feeding = true;
  if (t.configured && t.configured_sequence == t.sequence)
    requests_.push_back(ResetDecoder{t.decoder});
  else
    t.configured = false;
}

bool PlayerImpl::feedNext(Track& t, Request& out) {
  if (!t.feeding || !ready(t)) return false;
  const package::StreamIndex& index = stateOf(t).index;
  const package::SampleTable& table = index.renditions[0];
  const package::Rendition& rendition = wantedOf(t).renditions[0];
  if (!t.configured) {
    t.configured = true;
    t.configured_sequence = t.sequence;
    out = ConfigureDecoder{t.decoder, rendition.codec, table.decoder_description, rendition.width, rendition.height};
    return true;
  }
  if (t.feed_done) {
    if (t.flushed) return false;
    t.flushed = true;
    out = FlushDecoder{t.decoder};
    return true;
  }
  if (t.in_flight.size() + usedSlots(t) >= t.slots.size() + t.reorder_allowance) return false;
  const stream::Gop* gop = cache_.find({t.sequence, t.feed_gop});
  if (!gop || gop->video_state != stream::PartState::Present) return false;
  const uint32_t first = table.chunk_first_sample[t.feed_gop];
  const package::VideoSample& sample = table.samples[first + t.feed_sample];
  const uint64_t offset = sample.offset - table.samples[first].offset;
  const int64_t k = t.feed_gop_k + (sample.frame - index.chunks[t.feed_gop].first_frame);
  const int64_t serial = t.serial_base + k;
  t.next_serial = std::max(t.next_serial, serial + 1);
  const int64_t timestamp_us = serial * kTimestampStep_us;
  t.in_flight[timestamp_us] = k;
  out = DecodeSample{t.decoder, std::span<const uint8_t>(gop->video).subspan(offset, sample.bytes), timestamp_us,
                     sample.key};
  if (first + ++t.feed_sample == table.chunk_first_sample[t.feed_gop + 1]) finishGop(t);
  return true;
}

void PlayerImpl::finishGop(Track& t) {
  const package::StreamIndex& index = stateOf(t).index;
  const bool last = t.feed_gop + 1 == index.chunks.size();
  if (last && !looping(t)) {
    t.feed_done = true;
    return;
  }
  t.feed_gop_k += index.chunks[t.feed_gop].frame_count;
  t.feed_gop = last ? 0 : t.feed_gop + 1;
  t.feed_sample = 0;
}

// Frees decoder and pictures; pictures that are being filled go when they are committed.
void PlayerImpl::closeTrack(Track& t) {
  if (!t.used()) return;
  stopFeed(t);
  for (Slot& slot : t.slots) {
    if (slot.state == Slot::State::Filling) continue;
    slot.state = Slot::State::Free;
    release(slot);
  }
  if (t.configured) requests_.push_back(CloseDecoder{t.decoder});
  t.configured = false;
  t.clock.setRunning(false);
  t.sequence = -1;
  t.shown = {};
  t.appearance.reset();
}

Status PlayerImpl::preparePicture(const Track& t, Slot& slot) {
  const package::Rendition& rendition = wantedOf(t).renditions[0];
  if (slot.width == rendition.width && slot.height == rendition.height) return {};
  auto picture = render::createPicture(device_, rendition.width, rendition.height, options_.picture_kind);
  if (!picture.ok()) return picture.error();
  slot.picture = picture.take();
  slot.width = rendition.width;
  slot.height = rendition.height;
  return {};
}

// Null for a number that is none. Slots are numbered over both decoders.
Slot* PlayerImpl::slotAt(int slot, Track*& track) {
  const int each = options_.picture_slots;
  if (slot < 0 || slot >= kDecoders * each) return nullptr;
  track = &tracks_[static_cast<size_t>(slot / each)];
  return &track->slots[static_cast<size_t>(slot % each)];
}

int PlayerImpl::acquireSlot(int decoder, int64_t timestamp_us) {
  if (decoder < 0 || decoder >= kDecoders) return -2;
  Track& t = tracks_[static_cast<size_t>(decoder)];
  auto it = t.in_flight.find(timestamp_us);
  if (it == t.in_flight.end()) return -2;
  t.ticks_without_output = 0;
  const int64_t k = it->second;
  if (k < t.drop_before_k) {
    t.in_flight.erase(it);
    return -2;
  }
  auto free = std::find_if(t.slots.begin(), t.slots.end(), [](const Slot& s) { return s.state == Slot::State::Free; });
  if (free == t.slots.end()) return -1;
  t.in_flight.erase(it);
  if (Status status = preparePicture(t, *free); !status.ok()) {
    if (&t == &main())
      fail(status.error(), -1);
    else
      selectInstead();
    return -2;
  }
  free->state = Slot::State::Filling;
  free->sequence = t.sequence;
  free->k = k;
  free->epoch = t.epoch;
  free->wrong_frame = false;
  return decoder * options_.picture_slots + static_cast<int>(free - t.slots.begin());
}

void PlayerImpl::uploadI420(int slot_number, const I420View& picture) {
  Track* track = nullptr;
  Slot* found = slotAt(slot_number, track);
  if (!found) return;
  Slot& slot = *found;
  const Track& t = *track;
  if (slot.state != Slot::State::Filling || slot.epoch != t.epoch) return;
  const package::Rendition& rendition = wantedOf(t).renditions[0];
  if (picture.width != rendition.width || picture.height != rendition.height) {
    slot.wrong_frame = true;
    fail({ErrorId::VideoInvalid, rendition.video_uri + ": pictures are " + std::to_string(picture.width) + "x" +
                                     std::to_string(picture.height) + ", the manifest says " +
                                     std::to_string(rendition.width) + "x" + std::to_string(rendition.height)},
         t.sequence);
    return;
  }
  const uint32_t expected = frameOf(t, slot.k) % 4096;
  const std::optional<uint32_t> seen = package::readBarcode(rendition.barcode, picture);
  ++stats_.barcode_checked;
  if (!seen || *seen != expected) {
    ++stats_.barcode_mismatches;
    slot.wrong_frame = true;
    if (t.seeking && slot.k == t.wanted_k)
      fail({ErrorId::VideoInvalid, rendition.video_uri + ": frame " + std::to_string(expected) +
                                       " carries another frame's barcode; the file is damaged"},
           t.sequence);
    return;
  }
  render::uploadPicture(device_, slot.picture, picture);
}

gpu::TextureId PlayerImpl::slotTexture(int slot) const {
  Track* track = nullptr;
  const Slot* found = const_cast<PlayerImpl*>(this)->slotAt(slot, track);
  return found ? found->picture.rgba.id() : 0;
}

void PlayerImpl::commitSlot(int slot_number) {
  Track* track = nullptr;
  Slot* slot = slotAt(slot_number, track);
  if (!slot || slot->state != Slot::State::Filling) return;
  const bool wanted = slot->epoch == track->epoch && !slot->wrong_frame;
  slot->state = wanted ? Slot::State::Ready : Slot::State::Free;
  if (!track->used()) release(*slot);
}

void PlayerImpl::onDecoderFailed(int decoder, const std::string& reason) {
  if (decoder < 0 || decoder >= kDecoders) return;
  Track& t = tracks_[static_cast<size_t>(decoder)];
  if (!t.used()) return;
  t.configured = false;
  if (&t != &main()) {
    requests_.push_back(CloseDecoder{decoder});
    selectInstead();
    return;
  }
  const ErrorId id = reason.rfind("unsupported", 0) == 0 ? ErrorId::DecoderUnsupported : ErrorId::VideoInvalid;
  fail({id, wantedOf(t).renditions[0].video_uri + ": the video does not decode (" + reason + ")"}, t.sequence);
}

bool PlayerImpl::nextRequest(Request& out) {
  if (!requests_.empty()) {
    out = std::move(requests_.front());
    requests_.pop_front();
    return true;
  }
  if (feedNext(main(), out) || feedNext(other(), out)) return true;
  for (Track& t : tracks_) {
    if (!t.feeding || t.in_flight.empty()) continue;
    // A decoder that keeps more pictures back than expected must not starve.
    if (++t.ticks_without_output > 60 && usedSlots(t) <= 1) {
      t.reorder_allowance = std::min(t.reorder_allowance + 4, kMaxReorderAllowance);
      t.ticks_without_output = 0;
    }
  }
  return false;
}

}  // namespace fourdvt

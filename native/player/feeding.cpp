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
}

void PlayerImpl::stopFeed() {
  feeding_ = false;
  in_flight_.clear();
  ++epoch_;
  for (size_t i = 0; i < slots_.size(); ++i)
    if (slots_[i].state == Slot::State::Ready && static_cast<int>(i) != shown_.slot) slots_[i].state = Slot::State::Free;
}

// Starts decoding at the GOP that holds the wanted presentation.
void PlayerImpl::restartFeed() {
  stopFeed();
  const package::StreamIndex& index = sequences_[static_cast<size_t>(active_)].index;
  const uint32_t frame = frameOf(wanted_k_);
  feed_gop_ = index.chunkOfFrame(frame);
  feed_gop_k_ = wanted_k_ - (frame - index.chunks[feed_gop_].first_frame);
  feed_sample_ = 0;
  drop_before_k_ = wanted_k_;
  serial_base_ = next_serial_ - feed_gop_k_;  // timestamps never repeat, whatever is sought
  feed_done_ = flushed_ = false;
  feeding_ = true;
  if (configured_ && configured_sequence_ == active_)
    requests_.emplace_back(std::in_place_type<ResetDecoder>);
  else
    configured_ = false;
}

size_t PlayerImpl::usedSlots() const {
  return static_cast<size_t>(
      std::count_if(slots_.begin(), slots_.end(), [](const Slot& s) { return s.state != Slot::State::Free; }));
}

bool PlayerImpl::feedNext(Request& out) {
  if (!feeding_ || !ready()) return false;
  const package::StreamIndex& index = sequences_[static_cast<size_t>(active_)].index;
  const package::SampleTable& table = index.renditions[0];
  const package::Rendition& rendition = active().renditions[0];
  if (!configured_) {
    configured_ = true;
    configured_sequence_ = active_;
    out.emplace<ConfigureDecoder>(ConfigureDecoder{rendition.codec, table.decoder_description, rendition.width,
                                                   rendition.height});
    return true;
  }
  if (feed_done_) {
    if (flushed_) return false;
    flushed_ = true;
    out.emplace<FlushDecoder>();
    return true;
  }
  if (in_flight_.size() + usedSlots() >= static_cast<size_t>(options_.picture_slots) + reorder_allowance_) return false;
  const stream::Gop* gop = cache_.find({active_, feed_gop_});
  if (!gop || gop->video_state != stream::PartState::Present) return false;
  const uint32_t first = table.chunk_first_sample[feed_gop_];
  const package::VideoSample& sample = table.samples[first + feed_sample_];
  const uint64_t offset = sample.offset - table.samples[first].offset;
  const int64_t k = feed_gop_k_ + (sample.frame - index.chunks[feed_gop_].first_frame);
  const int64_t serial = serial_base_ + k;
  next_serial_ = std::max(next_serial_, serial + 1);
  const int64_t timestamp_us = serial * kTimestampStep_us;
  in_flight_[timestamp_us] = k;
  out.emplace<DecodeSample>(
      DecodeSample{std::span<const uint8_t>(gop->video).subspan(offset, sample.bytes), timestamp_us, sample.key});
  if (first + ++feed_sample_ == table.chunk_first_sample[feed_gop_ + 1]) finishGop();
  return true;
}

void PlayerImpl::finishGop() {
  const package::StreamIndex& index = sequences_[static_cast<size_t>(active_)].index;
  const bool last = feed_gop_ + 1 == index.chunks.size();
  if (last && !looping()) {
    feed_done_ = true;
    return;
  }
  feed_gop_k_ += index.chunks[feed_gop_].frame_count;
  feed_gop_ = last ? 0 : feed_gop_ + 1;
  feed_sample_ = 0;
}

Status PlayerImpl::preparePicture(Slot& slot) {
  const package::Rendition& rendition = active().renditions[0];
  if (slot.width == rendition.width && slot.height == rendition.height) return {};
  auto picture = render::createPicture(device_, rendition.width, rendition.height, options_.picture_kind);
  if (!picture.ok()) return picture.error();
  slot.picture = picture.take();
  slot.width = rendition.width;
  slot.height = rendition.height;
  return {};
}

int PlayerImpl::acquireSlot(int64_t timestamp_us) {
  auto it = in_flight_.find(timestamp_us);
  if (it == in_flight_.end()) return -2;
  ticks_without_output_ = 0;
  const int64_t k = it->second;
  if (k < drop_before_k_) {
    in_flight_.erase(it);
    return -2;
  }
  auto free = std::find_if(slots_.begin(), slots_.end(), [](const Slot& s) { return s.state == Slot::State::Free; });
  if (free == slots_.end()) return -1;
  in_flight_.erase(it);
  if (Status status = preparePicture(*free); !status.ok()) {
    fail(status.error(), -1);
    return -2;
  }
  free->state = Slot::State::Filling;
  free->sequence = active_;
  free->k = k;
  free->epoch = epoch_;
  free->wrong_frame = false;
  return static_cast<int>(free - slots_.begin());
}

void PlayerImpl::uploadI420(int slot_index, const I420View& picture) {
  if (slot_index < 0 || slot_index >= static_cast<int>(slots_.size())) return;
  Slot& slot = slots_[static_cast<size_t>(slot_index)];
  if (slot.state != Slot::State::Filling || slot.epoch != epoch_) return;
  const package::Rendition& rendition = active().renditions[0];
  if (picture.width != rendition.width || picture.height != rendition.height) {
    slot.wrong_frame = true;
    fail({ErrorId::VideoInvalid, rendition.video_uri + ": pictures are " + std::to_string(picture.width) + "x" +
                                     std::to_string(picture.height) + ", the manifest says " +
                                     std::to_string(rendition.width) + "x" + std::to_string(rendition.height)},
         active_);
    return;
  }
  const uint32_t expected = frameOf(slot.k) % 4096;
  const std::optional<uint32_t> seen = package::readBarcode(rendition.barcode, picture);
  ++stats_.barcode_checked;
  if (!seen || *seen != expected) {
    ++stats_.barcode_mismatches;
    slot.wrong_frame = true;
    if (seeking_ && slot.k == wanted_k_)
      fail({ErrorId::VideoInvalid, rendition.video_uri + ": frame " + std::to_string(expected) +
                                       " carries another frame's barcode; the file is damaged"},
           active_);
    return;
  }
  render::uploadPicture(device_, slot.picture, picture);
}

gpu::TextureId PlayerImpl::slotTexture(int slot) const {
  return slot >= 0 && slot < static_cast<int>(slots_.size()) ? slots_[static_cast<size_t>(slot)].picture.rgba.id() : 0;
}

void PlayerImpl::commitSlot(int slot_index) {
  if (slot_index < 0 || slot_index >= static_cast<int>(slots_.size())) return;
  Slot& slot = slots_[static_cast<size_t>(slot_index)];
  if (slot.state != Slot::State::Filling) return;
  const bool wanted = slot.epoch == epoch_ && !slot.wrong_frame;
  slot.state = wanted ? Slot::State::Ready : Slot::State::Free;
}

void PlayerImpl::onDecoderFailed(const std::string& reason) {
  if (active_ < 0) return;
  configured_ = false;
  const ErrorId id = reason.rfind("unsupported", 0) == 0 ? ErrorId::DecoderUnsupported : ErrorId::VideoInvalid;
  fail({id, active().renditions[0].video_uri + ": the video does not decode (" + reason + ")"}, active_);
}

bool PlayerImpl::nextRequest(Request& out) {
  if (!requests_.empty()) {
    out = std::move(requests_.front());
    requests_.pop_front();
    return true;
  }
  if (feedNext(out)) return true;
  if (!feeding_ || in_flight_.empty()) return false;
  // A decoder that keeps more pictures back than expected must not starve.
  if (++ticks_without_output_ > 60 && usedSlots() <= 1) {
    reorder_allowance_ = std::min(reorder_allowance_ + 4, kMaxReorderAllowance);
    ticks_without_output_ = 0;
  }
  return false;
}

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
#include "player/parts/pictures.h"

#include <algorithm>

namespace fourdvt {
void PictureSlots::Slot::release() {
  picture = {};
  bytes.reset();
  width = height = 0;
}

int PictureSlots::freeCount() const {
  return static_cast<int>(
      std::count_if(slots_.begin(), slots_.end(), [](const Slot& s) { return s.use == Slot::Use::Free; }));
}

int PictureSlots::readyCount() const {
  return static_cast<int>(std::count_if(
      slots_.begin(), slots_.end(), [this](const Slot& s) { return s.use == Slot::Use::Ready && s.epoch == epoch_; }));
}

int PictureSlots::findFree() const {
  const auto free = std::find_if(slots_.begin(), slots_.end(), [](const Slot& s) { return s.use == Slot::Use::Free; });
  return free == slots_.end() ? -1 : static_cast<int>(free - slots_.begin());
}

Status PictureSlots::prepare(gpu::Device& device, int number, const package::Rendition& rendition) {
  Slot& slot = at(number);
  if (kind_ != render::PictureTextures::Kind::Rgba) return {};
  if (slot.width == rendition.width && slot.height == rendition.height) return {};
  auto picture = render::createPicture(device, rendition.width, rendition.height, kind_);
  if (!picture.ok()) return picture.error();
  slot.picture = picture.take();
  slot.width = rendition.width;
  slot.height = rendition.height;
  return {};
}

void PictureSlots::fill(int number, int64_t k, uint32_t rendition) {
  Slot& slot = at(number);
  slot.use = Slot::Use::Filling;
  slot.k = k;
  slot.epoch = epoch_;
  slot.rendition = rendition;
  slot.rejected = false;
}

bool PictureSlots::awaits(int slot) const { return at(slot).use == Slot::Use::Filling && at(slot).epoch == epoch_; }

void PictureSlots::hold(int number, const I420View& picture, PictureBytes bytes) {
  at(number).view = picture;
  at(number).bytes = std::move(bytes);
}

const render::PictureTextures& PictureSlots::picture(int slot) const {
  return kind_ == render::PictureTextures::Kind::Rgba ? at(slot).picture : stages_[stage_].picture;
}

namespace {

// Region of one member's layers in a picture; the whole picture for one without members.
gpu::Region regionOf(const package::Rendition& rendition, size_t member, size_t members) {
  const size_t layers = rendition.layers.size() / members;
  if (members == 1 || layers == 0) return {.width = rendition.width, .height = rendition.height};
  int x = rendition.width, y = rendition.height, right = 0, bottom = 0;
  for (size_t i = member * layers; i < (member + 1) * layers; ++i) {
    const package::Rect& layer = rendition.layers[i];
    x = std::min(x, layer.x);
    y = std::min(y, layer.y);
    right = std::max(right, layer.x + layer.width);
    bottom = std::max(bottom, layer.y + layer.height);
  }
  return {x, y, right - x, bottom - y};
}

}  // namespace

Status PictureSlots::stage(gpu::Device& device, int number, const package::Rendition& rendition, size_t members,
                           uint32_t wanted) {
  Slot& slot = at(number);
  const uint32_t all = (1u << members) - 1;
  if (!slot.bytes) return {};  // kind Rgba, or completely uploaded
  if (stages_[stage_].slot != number) {
    stage_ = 1 - stage_;
    stages_[stage_].slot = number;
    stages_[stage_].there = 0;
  }
  Stage& stage = stages_[stage_];
  if (stage.width != slot.view.width || stage.height != slot.view.height ||
      stage.picture.kind != render::kindOf(slot.view)) {
    FOURDVT_ASSIGN(stage.picture,
                   render::createPicture(device, slot.view.width, slot.view.height, render::kindOf(slot.view)));
    stage.width = slot.view.width;
    stage.height = slot.view.height;
    stage.there = 0;
  }
  for (size_t m = 0; m < members; ++m) {
    if (!(wanted & ~stage.there & (1u << m))) continue;
    render::uploadPicture(device, stage.picture, slot.view, regionOf(rendition, m, members));
    stage.there |= 1u << m;
  }
  if (stage.there == all) slot.bytes.reset();
  return {};
}

void PictureSlots::commit(int number, bool in_use) {
  Slot& slot = at(number);
  if (slot.use != Slot::Use::Filling) return;
  if (slot.epoch == epoch_ && !slot.rejected)
    slot.use = Slot::Use::Ready;
  else
    slot.setFree();
  if (!in_use) slot.release();
}

void PictureSlots::drop(int number) {
  Slot& slot = at(number);
  if (slot.use == Slot::Use::Ready) slot.setFree();
  if (slot.use == Slot::Use::Filling) slot.rejected = true;
}

void PictureSlots::show(int number) {
  for (Slot& slot : slots_)
    if (slot.use == Slot::Use::Shown || (slot.use == Slot::Use::Ready && slot.k < k(number))) slot.setFree();
  at(number).use = Slot::Use::Shown;
  for (Stage& stage : stages_)
    if (stage.slot == number) stage.slot = -1;  // the texture held the slot's previous picture
}

int PictureSlots::findReady(int64_t k) const { return newestReady(k, k); }

int PictureSlots::newestReady(int64_t min_k, int64_t max_k) const {
  int newest = -1;
  for (int i = 0; holds(i); ++i) {
    const Slot& slot = at(i);
    if (slot.use != Slot::Use::Ready || slot.epoch != epoch_ || slot.k < min_k || slot.k > max_k) continue;
    if (newest < 0 || slot.k > k(newest)) newest = i;
  }
  return newest;
}

void PictureSlots::beginEpoch() {
  ++epoch_;
  for (Slot& slot : slots_)
    if (slot.use == Slot::Use::Ready) slot.setFree();
}

void PictureSlots::close() {
  for (Slot& slot : slots_) {
    if (slot.use == Slot::Use::Filling) continue;
    slot.use = Slot::Use::Free;
    slot.release();
  }
  stages_ = {};
}

namespace {
constexpr size_t kMaxReorderAllowance = 32;
constexpr int kMaxIdlePolls = 60;
constexpr int64_t kTimestampStep_us = 40000;  // independent of the sequence's frame rate
}  // namespace

void Feeding::stop() {
  active_ = false;
  in_flight_.clear();
}

void Feeding::restart(const FedSequence& fed, int64_t k, Outbox& outbox, bool preview) {
  stop();
  const auto frame = static_cast<uint32_t>(k % fed.sequence->frame_count);
  gop_ = fed.index->chunkOfFrame(frame);
  gop_k_ = k - (frame - fed.index->chunks[gop_].first_frame);
  gop_end_k_ = gop_k_ + fed.index->chunks[gop_].frame_count;
  sample_ = 0;
  drop_before_k_ = k;
  preview_k_ = preview ? gop_k_ : -1;
  serial_base_ = next_serial_ - gop_k_;
  done_ = flushed_ = lost_ = gave_ = false;
  active_ = true;
  if (fed.number != configured_sequence_) losses_ = 0;
  if (configured_ && configured_sequence_ == fed.number)
    outbox.request(ResetDecoder{decoder_});
  else
    configured_ = false;
}

bool Feeding::next(const FedSequence& fed, const std::vector<uint8_t>* video, int free_slots, Request& out) {
  if (!active_) return false;
  if (configured_ && !done_ && !begun() && video && configured_rendition_ != fed.rendition) {
    if (!in_flight_.empty()) {
      if (flushed_) return false;
      flushed_ = true;
      out = FlushDecoder{decoder_};
      return true;
    }
    configured_ = flushed_ = false;
  }
  if (!configured_) {
    configured_ = true;
    configured_sequence_ = fed.number;
    configured_rendition_ = fed.rendition;
    const package::Rendition& rendition = fed.sequence->renditions[fed.rendition];
    out = ConfigureDecoder{decoder_, rendition.codec, fed.index->renditions[fed.rendition].decoder_description,
                           rendition.width, rendition.height};
    return true;
  }
  if (done_) {
    if (flushed_) return false;
    flushed_ = true;
    out = FlushDecoder{decoder_};
    return true;
  }
  if (!video || in_flight_.size() >= static_cast<size_t>(free_slots) + reorder_allowance_) return false;
  out = nextSample(fed, *video);
  return true;
}

DecodeSample Feeding::nextSample(const FedSequence& fed, std::span<const uint8_t> video) {
  const package::SampleTable& table = fed.index->renditions[fed.rendition];
  const uint32_t first = table.chunk_first_sample[gop_];
  const package::VideoSample& sample = table.samples[first + sample_];
  const int64_t k = gop_k_ + (sample.frame - fed.index->chunks[gop_].first_frame);
  const int64_t serial = serial_base_ + k;
  next_serial_ = std::max(next_serial_, serial + 1);
  const int64_t timestamp_us = serial * kTimestampStep_us;
  const bool wanted = k >= drop_before_k_ || k == preview_k_;
  if (wanted) in_flight_.push_back(timestamp_us);
  if (first + ++sample_ == table.chunk_first_sample[gop_ + 1]) finishGop(fed);
  return {decoder_, video.subspan(sample.offset - table.samples[first].offset, sample.bytes), timestamp_us, sample.key,
          wanted};
}

void Feeding::finishGop(const FedSequence& fed) {
  const std::vector<package::ChunkEntry>& chunks = fed.index->chunks;
  const bool last = gop_ + 1 == chunks.size();
  if (last && !fed.loops) {
    done_ = true;
    return;
  }
  gop_k_ = gop_end_k_;
  gop_ = last ? 0 : gop_ + 1;
  gop_end_k_ += chunks[gop_].frame_count;
  sample_ = 0;
}

void Feeding::noteIdlePoll(int used_slots) {
  if (!active_ || in_flight_.empty()) return;
  if (++idle_polls_ <= kMaxIdlePolls || used_slots > 1) return;
  reorder_allowance_ = std::max(reorder_allowance_, std::min(reorder_allowance_ + 4, kMaxReorderAllowance));
  idle_polls_ = 0;
}

std::optional<int64_t> Feeding::presentationOf(int64_t timestamp_us) {
  if (std::find(in_flight_.begin(), in_flight_.end(), timestamp_us) == in_flight_.end()) return std::nullopt;
  idle_polls_ = 0;
  const int64_t k = timestamp_us / kTimestampStep_us - serial_base_;
  if (k >= suspect_until_k_) losses_ = 0;
  gave_ = true;
  return k;
}

void Feeding::take(int64_t timestamp_us) {
  std::erase_if(in_flight_, [&](int64_t waiting) { return waiting <= timestamp_us; });
}

void Feeding::awaitAgain(int64_t k) {
  if (active_) in_flight_.push_back((serial_base_ + k) * kTimestampStep_us);
}

void Feeding::loseDecoder(DecoderFault fault) {
  stop();
  configured_ = false;
  lost_ = true;
  ++losses_;
  suspect_until_k_ = fault == DecoderFault::Samples ? gop_end_k_ : INT64_MIN;
}

void Feeding::close(Outbox& outbox) {
  if (configured_) outbox.request(CloseDecoder{decoder_});
  configured_ = false;
  lost_ = true;
}

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
#include "player/parts/feeding.h"

#include <algorithm>

namespace fourdvt {

namespace {
constexpr size_t kMaxReorderAllowance = 32;
constexpr int kMaxIdlePolls = 60;
constexpr int64_t kTimestampStep_us = 40000;  // whatever the sequence's frame rate
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

// SPDX-License-Identifier: Apache-2.0
// What one decoder is fed: configuration, then the samples of one GOP after the other in decoding order, from the key
// sample of the GOP that holds the wanted presentation on; and which presentation a picture that comes back belongs to.
// A sample's timestamp is a serial number that never repeats, so that a picture from before a seek finds nobody who
// waits for it. Does NOT hold pictures (picture_slots.h), does NOT fetch GOPs (loading.h), does NOT call the decoder:
// the edge polls `next`.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "package/character.h"
#include "package/stream_file.h"
#include "player/parts/outbox.h"

namespace fourdvt {

// The sequence that is fed; borrowed for a call.
struct FedSequence {
  int number = -1;  // among the character's sequences
  const package::Sequence* sequence = nullptr;
  const package::StreamIndex* index = nullptr;
  bool loops = false;
  uint32_t rendition = 0;  // among those of the sequence
};

class Feeding {
 public:
  // samples_ahead: that the decoder may hold beyond the free slots, at first.
  explicit Feeding(int decoder, size_t samples_ahead = 4) : decoder_(decoder), reorder_allowance_(samples_ahead) {}

  // Nobody waits for the pictures under way any more.
  void stop();
  // Starts again at the GOP that holds presentation k: frames since the sequence's start, unwrapped over loops.
  // Samples before k are fed for those that refer to them; nothing waits for their pictures, but for the GOP's key if
  // that is to be shown meanwhile (preview).
  void restart(const FedSequence& fed, int64_t k, Outbox& outbox, bool preview = false);
  // The decoder's next request; false: it must have none now. A GOP in another rendition waits until the pictures
  // before it have been taken: the decoder gives them back, and is configured anew. video: the samples of `gop()`, null
  // while they are not there. The decoder holds at most as many samples as there are free slots, and a few that it may
  // need to reorder.
  bool next(const FedSequence& fed, const std::vector<uint8_t>* video, int free_slots, Request& out);
  // Call after a poll that brought nothing: a decoder that keeps more pictures back than expected must not starve.
  void noteIdlePoll(int used_slots);

  // The presentation that a decoded picture is for; null: nobody waits for it.
  std::optional<int64_t> presentationOf(int64_t timestamp_us);
  // Nobody waits for it any more, nor for those before it: pictures come in the order of presentation, and a decoder
  // may leave some out.
  void take(int64_t timestamp_us);
  void awaitAgain(int64_t k);  // a presentation whose picture was taken, and was another one's

  // The decoder is gone, and with it what it held: stops until `restart`.
  void loseDecoder(DecoderFault fault);
  // The decoder has been lost too often in a row for another try to be of use. A picture ends the row; if the samples
  // were at fault, one that comes after those.
  bool hopeless() const { return losses_ > kMaxLosses; }
  void close(Outbox& outbox);  // after stop(); frees the decoder until `restart`

  // Samples are in the decoder, and it has given a picture since `restart`: the next one is only a matter of its speed.
  bool decoding() const { return active_ && gave_ && !in_flight_.empty(); }
  bool active() const { return active_; }
  bool lost() const { return lost_; }                           // stopped by a loss, or closed; `restart` goes on
  bool done() const { return done_; }                           // a sequence that does not loop is fed to its end
  uint32_t gop() const { return gop_; }                         // the one being fed
  int64_t previewK() const { return preview_k_; }               // of that key; -1: none
  bool begun() const { return sample_ > 0; }                    // some of its samples have been
  uint32_t rendition() const { return configured_rendition_; }  // of the pictures that are awaited

 private:
  static constexpr int kMaxLosses = 3;
  DecodeSample nextSample(const FedSequence& fed, std::span<const uint8_t> video);
  void finishGop(const FedSequence& fed);

  int decoder_;
  bool gave_ = false;  // a picture that was waited for
  bool active_ = false, done_ = false, flushed_ = false;
  bool configured_ = false;
  int configured_sequence_ = -1;
  uint32_t configured_rendition_ = 0;
  uint32_t gop_ = 0, sample_ = 0;
  int64_t gop_k_ = 0, gop_end_k_ = 0;  // presentations of the GOP's first frame, and of the one after its last
  int64_t drop_before_k_ = 0, preview_k_ = -1;
  int64_t serial_base_ = 0;  // serial = serial_base_ + k
  int64_t next_serial_ = 0;
  std::vector<int64_t> in_flight_;  // timestamps, in any order
  size_t reorder_allowance_;        // samples the decoder may hold beyond the slots; grows if it holds more
  int idle_polls_ = 0;              // since a picture came back
  bool lost_ = false;
  int losses_ = 0;               // of the decoder, in a row
  int64_t suspect_until_k_ = 0;  // pictures before this one do not end the row
};

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
// Pictures of one decoder: its input samples (Feeding) and its decoded pictures (PictureSlots). Playhead selects the
// one to show.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "package/character.h"
#include "package/stream_file.h"
#include "player/parts/messages.h"
#include "render/character_model.h"

namespace fourdvt {

// Picture slots of one decoder: decoded pictures and their presentations. A slot is free, being filled, ready, or on
// screen. Pictures of an earlier epoch (before a seek or another sequence) are never shown.
// Pictures of kind Rgba are textures, one per slot, filled by the edge. Others stay in memory until they are on screen:
// then the drawn members are copied into textures, further members when they gain a weight.
// Order of calls for a slot: findFree → prepare → fill → hold, or renumber → commit → show → stage.
class PictureSlots {
 public:
  PictureSlots(int count, render::PictureTextures::Kind kind) : kind_(kind), slots_(static_cast<size_t>(count)) {}

  bool holds(int slot) const { return slot >= 0 && slot < static_cast<int>(slots_.size()); }
  int freeCount() const;
  int readyCount() const;  // present epoch only
  int usedCount() const { return static_cast<int>(slots_.size()) - freeCount(); }
  int findFree() const;  // -1: none
  // Kind Rgba: creates the slot's texture at the rendition's size. Errors: GpuFailure.
  Status prepare(gpu::Device& device, int slot, const package::Rendition& rendition);
  // k: presentation, frames since the sequence's start, unwrapped over loops; rendition: as in `prepare`.
  void fill(int slot, int64_t k, uint32_t rendition);
  // Returns true while the slot is being filled for the present epoch.
  bool awaits(int slot) const;
  void renumber(int slot, int64_t k) { at(slot).k = k; }  // corrects its presentation
  void hold(int slot, const I420View& picture, PictureBytes bytes);
  void reject(int slot) { at(slot).rejected = true; }  // hides the picture being filled
  // Completes filling: ready, or free again if the picture is obsolete. Not `in_use`: frees its texture.
  void commit(int slot, bool in_use);
  void drop(int slot);  // discards its picture unless on screen
  // Puts a ready picture on screen; frees the previous one and the ready ones before it.
  void show(int slot);
  // Uploads missing layers of the picture on screen: those of these members (bit m: member m), or all of a picture
  // without members. Errors: GpuFailure.
  Status stage(gpu::Device& device, int slot, const package::Rendition& rendition, size_t members, uint32_t wanted);

  int64_t k(int slot) const { return at(slot).k; }
  uint32_t rendition(int slot) const { return at(slot).rendition; }
  // Textures of the picture on screen, after `stage`; of kind Rgba those of any slot.
  const render::PictureTextures& picture(int slot) const;
  // Ready picture of presentation k in the present epoch; -1: none.
  int findReady(int64_t k) const;
  int newestReady(int64_t min_k, int64_t max_k) const;

  void beginEpoch();  // frees ready pictures; commit frees those being filled
  void close();       // frees all slots, and all textures but those being filled

 private:
  struct Slot {
    enum class Use { Free, Filling, Ready, Shown } use = Use::Free;
    int64_t k = 0;
    uint32_t epoch = 0, rendition = 0;
    bool rejected = false;
    int width = 0, height = 0;        // size of `picture`
    render::PictureTextures picture;  // kind Rgba only
    I420View view;                    // other kinds: view into `bytes`
    PictureBytes bytes;
    void release();
    void setFree() { use = Use::Free, bytes.reset(); }
  };
  // Alternating textures of the pictures on screen: the GPU may still read the previous picture's.
  struct Stage {
    render::PictureTextures picture;
    int width = 0, height = 0;
    int slot = -1;
    uint32_t there = 0;  // uploaded members, bit mask
  };
  Slot& at(int slot) { return slots_[static_cast<size_t>(slot)]; }
  const Slot& at(int slot) const { return slots_[static_cast<size_t>(slot)]; }

  render::PictureTextures::Kind kind_;
  std::vector<Slot> slots_;
  std::array<Stage, 2> stages_;
  size_t stage_ = 0;  // stage used last
  uint32_t epoch_ = 0;
};

// Sequence to feed; borrowed for a call.
struct FedSequence {
  int number = -1;  // index among the character's sequences
  const package::Sequence* sequence = nullptr;
  const package::StreamIndex* index = nullptr;
  bool loops = false;
  uint32_t rendition = 0;  // index among the sequence's renditions
};

// Input of one decoder: configuration, then the samples of one GOP after the other in decoding order, from the key
// sample of the GOP that contains the requested presentation; and the mapping from returned pictures to presentations.
// Sample timestamps are unique serial numbers, so that pictures from before a seek match no presentation. The edge
// polls `next` and calls the decoder; loading.h fetches the GOPs.
class Feeding {
 public:
  // samples_ahead: initial allowance of samples in the decoder beyond the free slots.
  explicit Feeding(int decoder, size_t samples_ahead = 4) : decoder_(decoder), reorder_allowance_(samples_ahead) {}

  // Discards the pictures in flight.
  void stop();
  // Restarts at the GOP that contains presentation k: frames since the sequence's start, unwrapped over loops. Samples
  // before k are fed as references only; their pictures are dropped, except for the GOP's key if it is shown meanwhile
  // (preview).
  void restart(const FedSequence& fed, int64_t k, Outbox& outbox, bool preview = false);
  // Next request for the decoder; false: none for now. A GOP in another rendition waits until the pictures before it
  // have been taken: the decoder is flushed and configured anew. video: samples of `gop()`, null while not loaded.
  // Samples in the decoder: at most the number of free slots, plus an allowance for reordering.
  bool next(const FedSequence& fed, const std::vector<uint8_t>* video, int free_slots, Request& out);
  // Call after a poll without a request: raises the allowance for a decoder that holds back more pictures than
  // expected.
  void noteIdlePoll(int used_slots);

  // Presentation of a decoded picture; nullopt: not awaited.
  std::optional<int64_t> presentationOf(int64_t timestamp_us);
  // Ends the wait for this picture and all earlier ones: pictures come in presentation order, and a decoder may skip
  // some.
  void take(int64_t timestamp_us);
  void awaitAgain(int64_t k);  // awaits k again: the picture taken for it was another one

  // Handles the loss of the decoder and of its samples: stops until `restart`.
  void loseDecoder(DecoderFault fault);
  // Returns true after too many consecutive losses for another retry. A picture resets the count; after a fault of the
  // samples, only a picture beyond those samples does.
  bool hopeless() const { return losses_ > kMaxLosses; }
  void close(Outbox& outbox);  // stops and frees the decoder until `restart`

  // Returns true if samples are in the decoder and a picture has come since `restart`: the next picture depends on
  // decoding speed only.
  bool decoding() const { return active_ && gave_ && !in_flight_.empty(); }
  bool active() const { return active_; }
  bool lost() const { return lost_; }                           // stopped by a loss, or closed, until `restart`
  bool done() const { return done_; }                           // all samples of a sequence that does not loop are fed
  uint32_t gop() const { return gop_; }                         // GOP being fed
  int64_t previewK() const { return preview_k_; }               // presentation of the preview key; -1: none
  bool begun() const { return sample_ > 0; }                    // some samples of the GOP are fed
  uint32_t rendition() const { return configured_rendition_; }  // rendition of the awaited pictures

 private:
  static constexpr int kMaxLosses = 3;
  DecodeSample nextSample(const FedSequence& fed, std::span<const uint8_t> video);
  void finishGop(const FedSequence& fed);

  int decoder_;
  bool gave_ = false;  // an awaited picture arrived
  bool active_ = false, done_ = false, flushed_ = false;
  bool configured_ = false;
  int configured_sequence_ = -1;
  uint32_t configured_rendition_ = 0;
  uint32_t gop_ = 0, sample_ = 0;
  int64_t gop_k_ = 0, gop_end_k_ = 0;  // presentations of the GOP's first frame, and one past its last
  int64_t drop_before_k_ = 0, preview_k_ = -1;
  int64_t serial_base_ = 0;  // serial = serial_base_ + k
  int64_t next_serial_ = 0;
  std::vector<int64_t> in_flight_;  // timestamps, unordered
  size_t reorder_allowance_;        // samples allowed in the decoder beyond the free slots; grows on demand
  int idle_polls_ = 0;              // since the last picture
  bool lost_ = false;
  int losses_ = 0;               // consecutive losses of the decoder
  int64_t suspect_until_k_ = 0;  // earlier pictures leave losses_ unchanged
};

}  // namespace fourdvt

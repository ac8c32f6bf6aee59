// SPDX-License-Identifier: Apache-2.0
// Pictures of one decoder: the samples that it is fed (Feeding), and the decoded pictures (PictureSlots). Which one is
// shown is chosen by the Playhead.
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

// The picture slots of one decoder: its decoded pictures, and the presentation that each one holds. A slot is free,
// being filled, ready, or on screen. Pictures of an earlier epoch (before a seek or another sequence) are never shown.
// Pictures of kind Rgba are in textures, one per slot, that the edge fills. Others stay in memory until they are on
// screen: then what is drawn of them is copied into textures, and more of it when more is. Order of calls for a slot:
// findFree → prepare → fill → hold, or renumber → commit → show → stage.
class PictureSlots {
 public:
  PictureSlots(int count, render::PictureTextures::Kind kind) : kind_(kind), slots_(static_cast<size_t>(count)) {}

  bool holds(int slot) const { return slot >= 0 && slot < static_cast<int>(slots_.size()); }
  int freeCount() const;
  int readyCount() const;  // of the present epoch
  int usedCount() const { return static_cast<int>(slots_.size()) - freeCount(); }
  int findFree() const;  // -1: none
  // Kind Rgba: gives the slot a texture of the rendition's size. Errors: GpuFailure.
  Status prepare(gpu::Device& device, int slot, const package::Rendition& rendition);
  // k: the presentation, frames since the sequence's start, unwrapped over loops; rendition: as of `prepare`.
  void fill(int slot, int64_t k, uint32_t rendition);
  // It is being filled for the present epoch.
  bool awaits(int slot) const;
  void renumber(int slot, int64_t k) { at(slot).k = k; }  // it is another presentation's
  void hold(int slot, const I420View& picture, PictureBytes bytes);
  void reject(int slot) { at(slot).rejected = true; }  // what it is being filled with must not be shown
  // It is filled: ready from now on, or free again if nobody wants it. Not `in_use`: its texture is freed.
  void commit(int slot, bool in_use);
  void drop(int slot);  // nobody wants its picture any more; one on screen stays
  // Puts a ready picture on screen; frees the one before and the ready ones that it overtakes.
  void show(int slot);
  // Copies what is missing of these members' layers (bit m: member m), or of all of a picture without members, of the
  // picture on screen. Errors: GpuFailure.
  Status stage(gpu::Device& device, int slot, const package::Rendition& rendition, size_t members, uint32_t wanted);

  int64_t k(int slot) const { return at(slot).k; }
  uint32_t rendition(int slot) const { return at(slot).rendition; }
  // Textures of the picture on screen, once it is staged; of kind Rgba those of any slot.
  const render::PictureTextures& picture(int slot) const;
  // Ready pictures of the present epoch; -1: none.
  int findReady(int64_t k) const;
  int newestReady(int64_t min_k, int64_t max_k) const;

  void beginEpoch();  // frees ready pictures; those that are being filled go when they are committed
  void close();       // frees all, and all textures but for those that are being filled

 private:
  struct Slot {
    enum class Use { Free, Filling, Ready, Shown } use = Use::Free;
    int64_t k = 0;
    uint32_t epoch = 0, rendition = 0;
    bool rejected = false;
    int width = 0, height = 0;        // of `picture`
    render::PictureTextures picture;  // kind Rgba
    I420View view;                    // other kinds: into `bytes`
    PictureBytes bytes;
    void release();
    void setFree() { use = Use::Free, bytes.reset(); }
  };
  // Textures that pictures on screen take turns in: the GPU may still read those of the one before.
  struct Stage {
    render::PictureTextures picture;
    int width = 0, height = 0;
    int slot = -1;
    uint32_t there = 0;  // members
  };
  Slot& at(int slot) { return slots_[static_cast<size_t>(slot)]; }
  const Slot& at(int slot) const { return slots_[static_cast<size_t>(slot)]; }

  render::PictureTextures::Kind kind_;
  std::vector<Slot> slots_;
  std::array<Stage, 2> stages_;
  size_t stage_ = 0;  // the one that was taken last
  uint32_t epoch_ = 0;
};

// The sequence that is fed; borrowed for a call.
struct FedSequence {
  int number = -1;  // among the character's sequences
  const package::Sequence* sequence = nullptr;
  const package::StreamIndex* index = nullptr;
  bool loops = false;
  uint32_t rendition = 0;  // among those of the sequence
};

// Input of one decoder: configuration, then the samples of one GOP after the other in decoding order, from the key
// sample of the GOP that holds the wanted presentation on; and which presentation a picture that comes back belongs to.
// A sample's timestamp is a serial number that never repeats, so that nothing waits for a picture from before a seek.
// Does NOT fetch GOPs (loading.h) and does NOT call the decoder: the edge polls `next`.
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

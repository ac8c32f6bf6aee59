// SPDX-License-Identifier: Apache-2.0
// The picture slots of one decoder: its decoded pictures, and the presentation that each one holds. A slot is free,
// being filled, ready, or on screen. Pictures of an earlier epoch (before a seek or another sequence) are never shown.
// Pictures of kind Rgba are in textures, one per slot, that the edge fills. Others stay in memory until they are on
// screen: then what is drawn of them is copied into textures, and more of it when more is. Does NOT decode (feeding.h)
// and does NOT decide what is shown (playhead.h). Order of calls for a slot: findFree → prepare → fill → hold, or
// renumber → commit → show → stage.
#pragma once

#include <array>
#include <vector>

#include "player/parts/messages.h"
#include "render/character_model.h"

namespace fourdvt {

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

}  // namespace fourdvt

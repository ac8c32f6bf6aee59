// SPDX-License-Identifier: Apache-2.0
#include "player/parts/picture_slots.h"

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

// The layers of one member of a picture; all of it where it has none.
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
  if (!slot.bytes) return {};  // kind Rgba, or all of it is there
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
    if (stage.slot == number) stage.slot = -1;  // of its picture before
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

}  // namespace fourdvt

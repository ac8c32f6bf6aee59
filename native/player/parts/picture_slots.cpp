// SPDX-License-Identifier: Apache-2.0
#include "player/parts/picture_slots.h"

#include <algorithm>

namespace fourdvt {

void PictureSlots::Slot::release() {
  picture = {};
  width = height = 0;
}

int PictureSlots::freeCount() const {
  return static_cast<int>(
      std::count_if(slots_.begin(), slots_.end(), [](const Slot& s) { return s.use == Slot::Use::Free; }));
}

int PictureSlots::readyCount() const {
  return static_cast<int>(std::count_if(slots_.begin(), slots_.end(), [this](const Slot& s) {
    return s.use == Slot::Use::Ready && s.epoch == epoch_;
  }));
}

int PictureSlots::findFree() const {
  const auto free = std::find_if(slots_.begin(), slots_.end(), [](const Slot& s) { return s.use == Slot::Use::Free; });
  return free == slots_.end() ? -1 : static_cast<int>(free - slots_.begin());
}

Status PictureSlots::prepare(gpu::Device& device, int number, const package::Rendition& rendition) {
  Slot& slot = at(number);
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

void PictureSlots::upload(gpu::Device& device, int slot, const I420View& picture) {
  render::uploadPicture(device, at(slot).picture, picture);
}

void PictureSlots::commit(int number, bool in_use) {
  Slot& slot = at(number);
  if (slot.use != Slot::Use::Filling) return;
  slot.use = slot.epoch == epoch_ && !slot.rejected ? Slot::Use::Ready : Slot::Use::Free;
  if (!in_use) slot.release();
}

void PictureSlots::drop(int number) {
  Slot& slot = at(number);
  if (slot.use == Slot::Use::Ready) slot.use = Slot::Use::Free;
  if (slot.use == Slot::Use::Filling) slot.rejected = true;
}

void PictureSlots::show(int number) {
  for (Slot& slot : slots_)
    if (slot.use == Slot::Use::Shown || (slot.use == Slot::Use::Ready && slot.k < k(number)))
      slot.use = Slot::Use::Free;
  at(number).use = Slot::Use::Shown;
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
    if (slot.use == Slot::Use::Ready) slot.use = Slot::Use::Free;
}

void PictureSlots::close() {
  for (Slot& slot : slots_) {
    if (slot.use == Slot::Use::Filling) continue;
    slot.use = Slot::Use::Free;
    slot.release();
  }
}

}  // namespace fourdvt

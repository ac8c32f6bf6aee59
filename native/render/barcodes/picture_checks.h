// SPDX-License-Identifier: Apache-2.0
// Reads the frame numbers of pictures that exist on the GPU only, where platform code uploads them into a slot's RGBA
// texture: draws the cells of a picture's barcode into a row of pixels and reads them back asynchronously. The player
// validates the numbers.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "gpu/device.h"
#include "package/barcode.h"

namespace fourdvt::render {

class PictureChecks {
 public:
  explicit PictureChecks(gpu::Device& device) : device_(device) {}
  PictureChecks(const PictureChecks&) = delete;
  PictureChecks& operator=(const PictureChecks&) = delete;
  ~PictureChecks();

  // Starts reading the picture's number, which `settle` returns with the slot. Errors: GpuFailure.
  Status begin(int slot, gpu::TextureId picture, const package::BarcodeStrip& strip);
  // Calls settled(slot, frame mod 4096) for each completed read, in the order of `begin`; nullopt: not a barcode.
  template <class Settled>
  void settle(const Settled& settled) {
    while (!pending_.empty()) {
      std::optional<uint32_t> frame;
      if (!read(pending_.front().read, frame)) return;
      const int slot = pending_.front().slot;
      pending_.erase(pending_.begin());
      settled(slot, frame);
    }
  }

 private:
  struct Pending {
    int slot = 0;
    gpu::ReadId read = 0;
  };
  Status prepare();
  bool read(gpu::ReadId id, std::optional<uint32_t>& frame);

  gpu::Device& device_;
  gpu::Program program_;
  gpu::Texture cells_;
  gpu::Target target_;
  std::vector<Pending> pending_;
};

}  // namespace fourdvt::render

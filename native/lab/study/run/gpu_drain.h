// SPDX-License-Identifier: Apache-2.0
// Waits for all GPU work so far, by one more pass that is read back: the GPU works in order.
#pragma once

#include "gpu/device.h"

namespace fourdvt::study {

class GpuDrain {
 public:
  Status prepare(gpu::Device& device) {
    FOURDVT_ASSIGN(color_, gpu::makeTexture(device, {.width = 1, .height = 1, .label = "drain"}));
    FOURDVT_ASSIGN(target_, gpu::makeTarget(device, {.colors = {color_.id()}, .label = "drain"}));
    return {};
  }
  Status wait(gpu::Device& device) const {
    device.beginPass({.target = target_.id(), .clear_color = true, .label = "drain"});
    device.endPass();
    uint8_t pixel[4];
    return device.readPixels(target_.id(), gpu::PixelFormat::RGBA8, {.width = 1, .height = 1}, pixel);
  }

 private:
  gpu::Texture color_;
  gpu::Target target_;
};

}  // namespace fourdvt::study

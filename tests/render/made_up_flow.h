// SPDX-License-Identifier: Apache-2.0
// Flow with a displacement that the test sets.
#pragma once

#include <vector>

#include "gpu/device.h"
#include "render/flow/flow.h"

namespace fourdvt::testing {

// Returns the same displacement everywhere.
class MadeUpFlow final : public render::FlowSource {
 public:
  MadeUpFlow(gpu::Device& device, const glm::vec2& flow, int& calls) : device_(device), value_(flow), calls_(calls) {}
  Status compute(gpu::TextureId, gpu::TextureId, int width, int height) override {
    ++calls_;
    texture_ = gpu::makeTexture(device_, {.format = gpu::PixelFormat::RG32F, .width = width, .height = height}).take();
    const std::vector<glm::vec2> all(size_t(width) * height, value_);
    device_.updateTexture(texture_.id(), {.width = width, .height = height}, all.data());
    return {};
  }
  gpu::TextureId flow() const override { return texture_.id(); }

 private:
  gpu::Device& device_;
  glm::vec2 value_;
  int& calls_;
  gpu::Texture texture_;
};

}  // namespace fourdvt::testing

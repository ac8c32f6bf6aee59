// SPDX-License-Identifier: Apache-2.0
// Offscreen rendering with read-back, at any size. One target is kept and remade when the size changes.
#pragma once

#include <functional>

#include "base/image.h"
#include "gpu/device.h"
#include "render/view.h"

namespace fourdvt::render {

class StillTarget {
 public:
  explicit StillTarget(gpu::Device& device) : device_(device) {}
  // Returns the target that `draw` fills (view.width × view.height, premultiplied) as straight RGBA, top row first.
  // Errors: those of draw, InvalidArgument (size beyond the device's), GpuFailure.
  Result<Image> render(const View& view, const std::function<Status(gpu::TargetId)>& draw);

 private:
  Status prepare(int width, int height);

  gpu::Device& device_;
  gpu::Texture color_;
  gpu::Target target_;
  int width_ = 0, height_ = 0;
};

}  // namespace fourdvt::render

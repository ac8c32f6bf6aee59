// SPDX-License-Identifier: Apache-2.0
// Which camera sees how much of which face: seven sample points against depth map, picture edge and matte, on the GPU.
#pragma once

#include "bake/texels/gpu_capture.h"

namespace fourdvt::bake {

class Visibility {
 public:
  // Errors: GpuFailure.
  static Result<Visibility> create(gpu::Device& device, const GpuCapture& capture);
  // Of the capture's current frame: [camera][face], 0..1.
  Result<std::vector<float>> measure(gpu::Device& device, const GpuCapture& capture);

 private:
  gpu::Program program_;
  gpu::Texture table_;
  gpu::Target target_;
  int rows_ = 0;  // a camera
};

}  // namespace fourdvt::bake

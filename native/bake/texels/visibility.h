// SPDX-License-Identifier: Apache-2.0
// Measures on the GPU how much of each face each camera sees: tests seven sample points per face against depth map,
// picture edge and matte.
#pragma once

#include "bake/texels/gpu_capture.h"

namespace fourdvt::bake {

class Visibility {
 public:
  // Errors: GpuFailure.
  static Result<Visibility> create(gpu::Device& device, const GpuCapture& capture);
  // What each camera sees of each face in the capture's current frame: [camera][face], 0…1.
  Result<std::vector<float>> measure(gpu::Device& device, const GpuCapture& capture);

 private:
  gpu::Program program_;
  gpu::Texture table_;
  gpu::Target target_;
  int rows_ = 0;  // rows per camera
};

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Camera pictures → texture layers in UV space on the GPU, per the labels. Does NOT fill what no camera shows.
#pragma once

#include "bake/gpu_capture.h"

namespace fourdvt::bake {

class Resampler {
 public:
  // sizes: texels, side of each layer. Errors: GpuFailure.
  static Result<Resampler> create(gpu::Device& device, const GpuCapture& capture, const std::vector<int>& sizes);
  // labels: [layer][face]. Result: a layer each, RGBA, alpha 255 where resampled, else 0; row 0 = UV row 0.
  Result<std::vector<Image>> resample(gpu::Device& device, const GpuCapture& capture,
                                      const std::vector<uint8_t>& labels);

 private:
  struct Layer {
    int size = 0;
    gpu::Texture texture;
    gpu::Target target;
  };
  struct Batch {  // faces of one layer and camera, a range of the face list
    int first = 0, count = 0;
  };
  std::vector<Batch> listFaces(gpu::Device& device, const std::vector<uint8_t>& labels, size_t cameras, size_t faces);
  gpu::Program program_;
  gpu::Texture face_list_;
  std::vector<Layer> layers_;
  std::vector<uint32_t> list_;
};

}  // namespace fourdvt::bake

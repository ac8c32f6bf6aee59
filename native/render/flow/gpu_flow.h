// SPDX-License-Identifier: Apache-2.0
// The two methods behind createGpuFlow. Does NOT prepare pictures or fade flow (FlowPictures, gpu_flow.cpp).
#pragma once

#include "render/flow/flow.h"
#include "render/flow/pictures.h"

namespace fourdvt::render {

// Flow of FlowPictures' luma pair before it is faded, of any size; gain: how many pixels of the pictures its unit is.
struct RawFlow {
  gpu::TextureId texture = 0;
  float gain = 1;
};

class FlowMethodPasses {
 public:
  virtual ~FlowMethodPasses() = default;
  virtual Status resize(gpu::Device& device, int width, int height) = 0;
  virtual RawFlow run(gpu::Device& device, gpu::TextureId pictures) = 0;
};

// As cv::calcOpticalFlowFarneback (box window): levels below the full size, none with a side under 32 pixels.
Result<std::unique_ptr<FlowMethodPasses>> createFarneback(gpu::Device& device, const FlowOptions& options);
// As cv::DISOpticalFlow, ultrafast: patches of 8 every 4 pixels from `finest` octaves below the size down (OpenCV's:
// 2), no variational refinement; but whole Gauss-Newton steps, and candidates from all neighbours instead of sweeps.
Result<std::unique_ptr<FlowMethodPasses>> createDis(gpu::Device& device, const FlowOptions& options);

}  // namespace fourdvt::render

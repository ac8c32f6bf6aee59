// SPDX-License-Identifier: Apache-2.0
// What flow on the GPU is made of (createGpuFlow): prepared pictures, buffers of one size, the two methods.
#pragma once

#include "gpu/device.h"
#include "render/flow/flow.h"

namespace fourdvt::render {

// What every FlowSource starts from: both pictures' luma, filled outside the character, and how far flow can be
// trusted. Two passes and a mipmap chain of RGBA8; needs no float targets. Does NOT compute flow.
class FlowPictures {
 public:
  // Errors: GpuFailure.
  Status prepare(gpu::Device& device, gpu::TextureId a, gpu::TextureId b, int width, int height);
  // RGBA8, width × height: luma of a, luma of b, unused, confidence. Outside the character both lumas are the same
  // smooth extension of their mean, so that the silhouette is no moving edge. Confidence falls to 0 a few pixels
  // outside the character, and where its luma is constant.
  gpu::TextureId texture() const { return filled_.id(); }
  gpu::TargetId target() const { return filled_target_.id(); }  // to read texture() back

 private:
  Status resize(gpu::Device& device, int width, int height);
  gpu::Program luma_, fill_;
  gpu::Texture premultiplied_, filled_;
  gpu::Target premultiplied_target_, filled_target_;
  int width_ = 0, height_ = 0;
};

// One full-screen draw into the whole target. Takes lists instead of vectors to keep the code at each call small.
void runFlowPass(gpu::Device& device, gpu::ProgramId program, gpu::TargetId target,
                 std::initializer_list<gpu::TextureBinding> textures, std::initializer_list<gpu::Uniform> uniforms);

struct FlowSize {
  int width = 0, height = 0;  // pixels
};

// Textures of one size that are drawn together.
struct FlowBuffer {
  gpu::Texture textures[3];
  gpu::Target target;
  int width = 0, height = 0;
  gpu::TextureId operator[](size_t i) const { return textures[i].id(); }
};

// 16F textures with linear filtering. Errors: GpuFailure.
Status makeFlowBuffer(gpu::Device& device, int width, int height, std::initializer_list<gpu::PixelFormat> formats,
                      FlowBuffer& out);
// Both lumas of FlowPictures at a level of the pyramid, made as OpenCV does: Gaussian blur at full size, then linear
// resize. Values are grey levels minus the middle one, where half floats are finest.
class ShrunkPair {
 public:
  // `level`: about `scale` times the pictures' size. Errors: GpuFailure.
  Status resize(gpu::Device& device, const FlowSize& pictures, const FlowSize& level, double scale);
  void draw(gpu::Device& device, const gpu::Program& shrink, gpu::TextureId pictures) const;  // flow_shrink.frag
  gpu::TextureId texture() const { return luma_[0]; }                                         // RG16F

 private:
  FlowBuffer rows_, luma_;
  glm::vec3 blur_x_{0}, blur_y_{0};  // u_blur of the shader
};

// fullscreen.vert with the embedded NAME.frag. Errors: GpuFailure.
Status makeFlowProgram(gpu::Device& device, const char* fragment, gpu::Program& out, const char* defines = "");

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

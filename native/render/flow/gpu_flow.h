// SPDX-License-Identifier: Apache-2.0
// Parts of flow on the GPU (createGpuFlow): prepared pictures, buffers of one size, the two methods.
#pragma once

#include "gpu/device.h"
#include "render/flow/flow.h"

namespace fourdvt::render {

// Input of every FlowSource: both pictures' luma, extended outside the character, and the flow's confidence. Two passes
// and a mipmap chain of RGBA8; requires no float targets.
class FlowPictures {
 public:
  // Errors: GpuFailure.
  Status prepare(gpu::Device& device, gpu::TextureId a, gpu::TextureId b, int width, int height);
  // RGBA8, width × height: luma of a, luma of b, unused, confidence. Outside the character both lumas are the same
  // smooth extension of their mean, which removes the moving edge of the silhouette. Confidence falls to 0 within a few
  // pixels outside the character, and where its luma is constant.
  gpu::TextureId texture() const { return filled_.id(); }
  gpu::TargetId target() const { return filled_target_.id(); }  // for read-back of texture()

 private:
  Status resize(gpu::Device& device, int width, int height);
  gpu::Program luma_, fill_;
  gpu::Texture premultiplied_, filled_;
  gpu::Target premultiplied_target_, filled_target_;
  int width_ = 0, height_ = 0;
};

// Makes one full-screen draw into the whole target. Lists in place of vectors reduce code size per call.
void runFlowPass(gpu::Device& device, gpu::ProgramId program, gpu::TargetId target,
                 std::initializer_list<gpu::TextureBinding> textures, std::initializer_list<gpu::Uniform> uniforms);

struct FlowSize {
  int width = 0, height = 0;  // pixels
};

// Textures of equal size with one common target.
struct FlowBuffer {
  gpu::Texture textures[3];
  gpu::Target target;
  int width = 0, height = 0;
  gpu::TextureId operator[](size_t i) const { return textures[i].id(); }
};

// Makes 16F textures with linear filtering. Errors: GpuFailure.
Status makeFlowBuffer(gpu::Device& device, int width, int height, std::initializer_list<gpu::PixelFormat> formats,
                      FlowBuffer& out);
// Both lumas of FlowPictures at a pyramid level, as in OpenCV: Gaussian blur at full size, then linear resize. Values
// are grey levels relative to mid-grey, where half floats are most precise.
class ShrunkPair {
 public:
  // level: about `scale` times the pictures' size. Errors: GpuFailure.
  Status resize(gpu::Device& device, const FlowSize& pictures, const FlowSize& level, double scale);
  void draw(gpu::Device& device, const gpu::Program& shrink, gpu::TextureId pictures) const;  // flow_shrink.frag
  gpu::TextureId texture() const { return luma_[0]; }                                         // RG16F

 private:
  FlowBuffer rows_, luma_;
  glm::vec3 blur_x_{0}, blur_y_{0};  // u_blur of the shader
};

// Makes a program of fullscreen.vert and the embedded NAME.frag. Errors: GpuFailure.
Status makeFlowProgram(gpu::Device& device, const char* fragment, gpu::Program& out, const char* defines = "");

// Flow of FlowPictures' luma pair before fading, of any size; gain: picture pixels per unit of the flow.
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

// Makes cv::calcOpticalFlowFarneback (box window): levels below the full size, sides at least 32 pixels.
Result<std::unique_ptr<FlowMethodPasses>> createFarneback(gpu::Device& device, const FlowOptions& options);
// Makes cv::DISOpticalFlow, ultrafast: patches of 8 every 4 pixels from `finest` octaves below the size down (OpenCV's:
// 2), without variational refinement. Differs in full Gauss-Newton steps, and candidates from all neighbours in place
// of sweeps.
Result<std::unique_ptr<FlowMethodPasses>> createDis(gpu::Device& device, const FlowOptions& options);

}  // namespace fourdvt::render

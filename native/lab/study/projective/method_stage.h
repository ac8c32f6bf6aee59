// SPDX-License-Identifier: Apache-2.0
// One frame of a capture, drawn by a method from its camera pictures as a character from cameras has them, but before
// the codec: filled outside the mattes, at full size, all cameras in one picture. Does NOT measure.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"
#include "edge/still_target.h"
#include "render/recipe.h"

namespace fourdvt::study {

class MethodStage {
 public:
  // Errors: GpuFailure.
  static Result<std::unique_ptr<MethodStage>> create(gpu::Device& device, std::vector<PinholeCamera> cameras);

  void setMethod(std::unique_ptr<render::Method> method) { recipe_->setMethod(std::move(method)); }
  // pictures: one per camera, RGBA with straight alpha (the matte). Errors: GpuFailure, InvalidArgument (the pictures
  // do not fit in a texture).
  Status setFrame(const TriangleMesh& surface, std::span<const Image> pictures);
  // From now on these are not used, as if they had no picture; by number.
  void leaveOut(std::span<const size_t> cameras);
  // From now on this is where the cameras are thought to be, as many and of the same sizes; before setFrame.
  void setCameras(std::vector<PinholeCamera> cameras);

  // RGBA straight alpha, top row first. With `elapsed_s` of the options it follows the picture before it.
  Result<Image> render(const PinholeCamera& view, const render::MethodOptions& options);
  Status draw(const render::View& view, const render::MethodOptions& options, gpu::TargetId target);

 private:
  MethodStage(gpu::Device& device, std::vector<PinholeCamera> cameras)
      : device_(device), still_(device), cameras_(std::move(cameras)) {}

  gpu::Device& device_;
  edge::StillTarget still_;
  std::unique_ptr<render::Recipe> recipe_;
  std::vector<PinholeCamera> cameras_;
  std::vector<render::CameraSource> sources_, used_;
  std::vector<size_t> left_out_;
  render::PictureTextures picture_;
  int width_ = 0, height_ = 0;  // texels of the picture
  uint64_t serial_ = 0;
  std::unique_ptr<render::CharacterModel> model_;
};

}  // namespace fourdvt::study

// SPDX-License-Identifier: Apache-2.0
// Renders one captured frame by a method, as the player renders a character from cameras, but from pictures before the
// codec: filled outside the mattes, at full size, all cameras in one picture. Bake and lab score methods on it
// (method_trial.h).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "bake/texels/colour_calibration.h"
#include "base/image.h"
#include "base/mesh.h"
#include "render/recipe.h"
#include "render/still_target.h"

namespace fourdvt::bake {

class FrameDrawing {
 public:
  // length_scale: lengthScale in base/mesh.h. Errors: GpuFailure.
  static Result<std::unique_ptr<FrameDrawing>> create(gpu::Device& device, std::vector<PinholeCamera> cameras,
                                                      double length_scale = 1);

  void setMethod(std::unique_ptr<render::Method> method) { recipe_->setMethod(std::move(method)); }
  // pictures: one per camera, RGBA with straight alpha (the matte). maps: colour maps, one per camera, or none.
  // Errors: GpuFailure, InvalidArgument (the pictures do not fit in a texture).
  Status setFrame(const TriangleMesh& surface, std::span<const Image> pictures, std::span<const ColourMap> maps = {});
  // Excludes these cameras, by number, from all later pictures.
  void leaveOut(std::span<const size_t> cameras);
  // Replaces the camera parameters by as many others of the same picture sizes; before setFrame.
  void setCameras(std::vector<PinholeCamera> cameras);

  // Returns RGBA with straight alpha, top row first. With `options.elapsed_s` the picture continues the previous one in
  // time.
  Result<Image> render(const PinholeCamera& view, const render::MethodOptions& options);
  Status draw(const render::View& view, const render::MethodOptions& options, gpu::TargetId target);

 private:
  FrameDrawing(gpu::Device& device, std::vector<PinholeCamera> cameras, double length_scale)
      : device_(device), still_(device), cameras_(std::move(cameras)), length_scale_(length_scale) {}

  gpu::Device& device_;
  render::StillTarget still_;
  std::unique_ptr<render::Recipe> recipe_;
  std::vector<PinholeCamera> cameras_;
  const double length_scale_;
  std::vector<render::CameraSource> sources_, used_;
  std::vector<size_t> left_out_;
  render::PictureTextures picture_;
  int width_ = 0, height_ = 0;  // texels of the picture
  uint64_t serial_ = 0;
  std::unique_ptr<render::CharacterModel> model_;
};

}  // namespace fourdvt::bake

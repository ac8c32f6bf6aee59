// SPDX-License-Identifier: Apache-2.0
#include "render/recipe.h"

#include <algorithm>

#include "render/passes.h"

namespace fourdvt::render {
namespace {

Status whyNotDrawable(const CharacterModel& model, const PictureTextures& picture, const View& view,
                      const RecipeOptions& options) {
  const auto invalid = [](const char* message) { return Error{ErrorId::InvalidArgument, message}; };
  if (model.geometry_serial == 0) return invalid("draw before the model's first setGeometry");
  if (model.layer_rects_uv.size() != static_cast<size_t>(model.layer_count))
    return invalid("the rendition has another number of layers than the character; call setLayout with its own");
  if (model.camera_count < 1) return invalid("the character has no cameras");
  if (picture.kind == PictureTextures::Kind::I420 ? !picture.y || !picture.u || !picture.v : !picture.rgba)
    return invalid("the picture's textures are missing; call createPicture");
  if (view.width < 1 || view.height < 1) return invalid("the view is empty; give it a width and a height");
  if (options.debug_layer < 0 || options.debug_layer >= model.layer_count) return invalid("no such debug layer");
  if (!(options.view_exponent > 0)) return invalid("view_exponent must be positive");
  return {};
}

class RecipeOnDevice final : public Recipe {
 public:
  RecipeOnDevice(gpu::Device& device, ShadowPass shadow) : device_(device), shadow_(std::move(shadow)) {}

  Status draw(const CharacterModel& model, const PictureTextures& picture, const View& view,
              const RecipeOptions& options, gpu::TargetId target) override {
    FOURDVT_TRY(whyNotDrawable(model, picture, view, options));
    FOURDVT_TRY(layered_.prepare(device_, model, picture.kind, options));
    FOURDVT_TRY(resize(view.width, view.height, std::clamp(options.samples, 0, device_.caps().max_samples)));
    if (options.ground_shadow) shadow_.cast(device_, model);
    device_.beginPass({.target = scene_.id(),
                       .width = view.width,
                       .height = view.height,
                       .clear_color = true,
                       .clear_depth = true,
                       .color = options.background,
                       .label = "character"});
    if (options.ground_shadow) shadow_.drawGround(device_, view, options.shadow_strength);
    layered_.draw(device_, model, picture, view, options);
    device_.endPass();
    device_.blit(scene_.id(), target, view.width, view.height);
    return {};
  }

 private:
  Status resize(int width, int height, int samples) {
    if (scene_ && width == width_ && height == height_ && samples == samples_) return {};
    scene_.reset();
    auto made = gpu::makeTarget(
        device_, {.width = width, .height = height, .samples = samples, .own_depth = true, .label = "scene"});
    if (!made) return made.error();
    scene_ = made.take();
    width_ = width;
    height_ = height;
    samples_ = samples;
    return {};
  }

  gpu::Device& device_;
  ShadowPass shadow_;
  LayeredPass layered_;
  gpu::Target scene_;
  int width_ = 0, height_ = 0, samples_ = 0;
};

}  // namespace

Result<std::unique_ptr<Recipe>> Recipe::create(gpu::Device& device) {
  auto shadow = ShadowPass::create(device);
  if (!shadow) return shadow.error();
  return std::unique_ptr<Recipe>(std::make_unique<RecipeOnDevice>(device, shadow.take()));
}

}  // namespace fourdvt::render

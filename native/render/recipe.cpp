// SPDX-License-Identifier: Apache-2.0
#include "render/recipe.h"

#include <algorithm>

#include "base/later.h"

namespace fourdvt::render {
namespace {

// Returns the height of the ground in the character's frame. Placements are upright.
float groundOf(const Figure& figure, const Scene* scene) {
  if (!scene) return static_cast<float>(figure.model->ground_y_m);
  const glm::vec4 feet = figure.world_from_character[3];
  return (glm::inverse(figure.world_from_character) * glm::vec4(feet.x, scene->ground_y_m, feet.z, 1)).y;
}

}  // namespace

struct Recipe::PlannedFigure {
  const CharacterModel* model;
  const CameraLook* cameras;
  CharacterView view;
  std::vector<Part> parts;
  gpu::TextureId picture = 0;  // the figure's finished picture; 0: drawn directly
};

Status Recipe::draw(std::span<const Figure> figures, const Scene* scene, const View& view, const DrawOptions& options,
                    gpu::TargetId target) {
  FOURDVT_TRY(check(figures, view, options));
  const RecipeOptions& recipe = options.recipe;
  FOURDVT_TRY(fit(figures, scene, view, options));
  if (scene) FOURDVT_TRY(scene_pass_.prepare(device_));
  std::vector<PlannedFigure> plan;
  for (const Figure& figure : figures) {
    plan.push_back({figure.model, figure.cameras, viewOfFigure(view, figure), {}});
    plan.back().view.origin = {region().x, region().y};
    if (!figure.cameras) plan.back().parts = partsOf(figure, options);
    FOURDVT_TRY(prepareFigure(plan.back(), plan.size() - 1, options));
    if (recipe.ground_shadow)
      FOURDVT_TRY(shadow_.cast(device_, plan.size() - 1, *figure.model, groundOf(figure, scene)));
  }
  const bool whole = region_.isWhole();
  beginMain(whole ? recipe.background : glm::vec4(0), "figures");
  if (scene) scene_pass_.draw(device_, *scene, view);
  if (whole) drawShadows(plan, recipe);
  for (size_t i = 0; i < plan.size(); ++i) drawFigure(plan[i], i, options);
  device_.endPass();
  if (whole)
    device_.blit(main_.id(), target, region());
  else
    putOver(plan, recipe, target);
  return {};
}

Result<bool> Recipe::makeNextProgram(int layer_count, int max_members, bool aligned, PictureTextures::Kind kind,
                                     const DrawOptions& options) {
  LayeredVariant variant{.layers = layer_count, .kind = kind, .debug = options.recipe.debug};
  for (; variant.members <= max_members; ++variant.members) {
    variant.aligned = aligned && variant.members > 1 && options.align == Align::Baked;
    if (layered().has(variant)) continue;
    FOURDVT_TRY(layered().prepare(device_, variant));
    return true;
  }
  if (mix_.ready()) return false;
  FOURDVT_TRY(later<&MixPass::prepare>(mix_, device_, false));
  return true;
}

Status Recipe::check(std::span<const Figure> figures, const View& view, const DrawOptions& options) const {
  const auto invalid = [](const char* message) { return Error{ErrorId::InvalidArgument, message}; };
  if (view.width < 1 || view.height < 1) return invalid("the view is empty; give it a width and a height");
  if (!(options.recipe.facing_exponent > 0 && options.recipe.view_exponent > 0))
    return invalid("facing_exponent and view_exponent must be positive");
  if (options.align == Align::Flow && !flow_)
    return Error{ErrorId::Unsupported, "alignment by flow needs a flow; call setFlow"};
  for (const Figure& figure : figures) {
    FOURDVT_TRY(checkFigure(figure, options.recipe));
    if (figure.cameras && !method_)
      return Error{ErrorId::Unsupported, "a character from cameras needs a method; call setMethod"};
  }
  return {};
}

void Recipe::beginMain(const glm::vec4& color, const char* label) {
  device_.beginPass({.target = main_.id(),
                     .x = -region().x,
                     .y = -region().y,
                     .width = region_.viewWidth(),
                     .height = region_.viewHeight(),
                     .clear_color = true,
                     .clear_depth = true,
                     .color = color,
                     .label = label});
}

Status Recipe::prepareFigure(PlannedFigure& figure, size_t number, const DrawOptions& options) {
  if (figure.cameras)
    FOURDVT_TRY(method_->prepare(device_, number, *figure.model, *figure.cameras, figure.view, options.method));
  for (const Part& part : figure.parts)
    FOURDVT_TRY(layered().prepare(device_, *figure.model, part, figure.view, options));
  const bool mixes = figure.parts.size() > 1;
  if (!mixes && !style_) return {};
  while (pictures_.size() <= number) pictures_.emplace_back();
  Canvas& picture = pictures_[number];
  FOURDVT_TRY(picture.prepare(device_, region().width, region().height));
  if (mixes) {
    FlowSource* flow = options.align == Align::Flow ? flow_.get() : nullptr;
    const int width = region().width, height = region().height;
    FOURDVT_TRY(later<&MixPass::begin>(mix_, device_, flow != nullptr, width, height));
    for (const Part& part : figure.parts) {
      drawAlone(figure, number, &part, mix_.canvas(), options);
      FOURDVT_TRY(later<&MixPass::add>(mix_, device_, part, flow, width, height, picture));
    }
  } else {
    drawAlone(figure, number, figure.parts.data(), picture, options);
  }
  figure.picture = picture.color.id();
  return {};
}

void Recipe::drawAlone(const PlannedFigure& figure, size_t number, const Part* part, const Canvas& out,
                       const DrawOptions& options) {
  beginMain(glm::vec4(0), "part");
  drawPart(figure, number, part, options);
  device_.endPass();
  device_.blit(main_.id(), out.target.id(), {.width = region().width, .height = region().height});
}

void Recipe::drawPart(const PlannedFigure& figure, size_t number, const Part* part, const DrawOptions& options) {
  if (figure.cameras)
    method_->draw(device_, number, *figure.model, *figure.cameras, figure.view, options.method);
  else
    layered().draw(device_, *figure.model, *part, figure.view, options);
}

void Recipe::drawFigure(const PlannedFigure& figure, size_t number, const DrawOptions& options) {
  if (!figure.picture)
    drawPart(figure, number, figure.parts.data(), options);
  else if (style_)
    style_->draw(device_, *figure.model, figure.picture, figure.view);
  else
    later<&MixPass::drawMesh>(mix_, device_, *figure.model, figure.picture, figure.view);
}

Status Recipe::fit(std::span<const Figure> figures, const Scene* scene, const View& view, const DrawOptions& options) {
  const int samples = std::clamp(options.recipe.samples, 0, device_.caps().max_samples);
  const bool all =
      options.align == Align::Flow || (scene && (scene->background || scene->room.corners || !scene->meshes.empty()));
  const bool resized = region_.update(figures, view, all);
  if (main_ && !resized && samples == samples_) return {};
  main_.reset();
  resolved_ = {};
  mix_.release();
  pictures_.clear();
  samples_ = samples;
  FOURDVT_ASSIGN(main_, gpu::makeTarget(device_, {.width = region().width,
                                                  .height = region().height,
                                                  .samples = samples,
                                                  .own_depth = true,
                                                  .label = "scene"}));
  return region_.isWhole() ? Status() : resolved_.prepare(device_, region().width, region().height);
}

void Recipe::drawShadows(const std::vector<PlannedFigure>& plan, const RecipeOptions& recipe) {
  for (size_t i = 0; recipe.ground_shadow && i < plan.size(); ++i)
    shadow_.drawGround(device_, i, plan[i].view, recipe.shadow_strength, region_.isWhole());
}

void Recipe::putOver(const std::vector<PlannedFigure>& plan, const RecipeOptions& recipe, gpu::TargetId target) {
  const auto [x, y, width, height] = region();
  device_.blit(main_.id(), resolved_.target.id(), {.width = width, .height = height});
  device_.beginPass({.target = target,
                     .width = region_.viewWidth(),
                     .height = region_.viewHeight(),
                     .clear_color = true,
                     .color = recipe.background,
                     .label = "shadows"});
  drawShadows(plan, recipe);
  device_.endPass();
  device_.beginPass({.target = target, .x = x, .y = y, .width = width, .height = height, .label = "figures over"});
  device_.draw({.program = over_.id(),
                .textures = {{"u_background", resolved_.color.id()}},
                .vertex_count = 3,
                .blend = gpu::Blend::PremultipliedOver});
  device_.endPass();
}

Status Canvas::prepare(gpu::Device& device, int width, int height) {
  if (target) return {};
  FOURDVT_ASSIGN(
      color,
      gpu::makeTexture(device,
                       {.width = width, .height = height, .filter = gpu::Filter::Linear, .label = "part of a figure"}));
  FOURDVT_ASSIGN(target, gpu::makeTarget(device, {.colors = {color.id()}, .label = "part of a figure"}));
  return {};
}

Result<std::unique_ptr<Recipe>> Recipe::create(gpu::Device& device) {
  auto shadow = ShadowPass::create(device);
  if (!shadow) return shadow.error();
  auto over = makeEmbeddedProgram(device, "fullscreen.vert", "background.frag", "DRAWN\n");
  if (!over) return over.error();
  return std::unique_ptr<Recipe>(new Recipe(device, shadow.take(), over.take()));
}

}  // namespace fourdvt::render

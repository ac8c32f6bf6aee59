// SPDX-License-Identifier: Apache-2.0
#include "render/plain_figure.h"

namespace fourdvt::render {

Result<PlainFigure> PlainFigure::create(gpu::Device& device, const package::Character& character,
                                        const package::BaseMesh& mesh) {
  auto model = CharacterModel::create(device, character, mesh);
  if (!model) return model.error();
  auto appearance = Appearance::create(device, model.value(), 1);
  if (!appearance) return appearance.error();
  PlainFigure figure;
  figure.model = model.take();
  figure.appearance = appearance.take();
  return figure;
}

void PlainFigure::setFrame(gpu::Device& device, std::span<const glm::vec3> positions, std::span<const uint8_t> labels) {
  model.setPositions(device, positions);
  appearance.setFrame(device, model, {labels, {}});
}

Status PlainFigure::draw(Recipe& recipe, const PictureTextures& picture, const View& view, const RecipeOptions& options,
                         gpu::TargetId target) const {
  constexpr float kWhole[] = {1};
  const Look look{&appearance, &picture, kWhole};
  const Figure figure{&model, {&look, 1}};
  return recipe.draw({&figure, 1}, nullptr, view, {options, Align::None}, target);
}

}  // namespace fourdvt::render

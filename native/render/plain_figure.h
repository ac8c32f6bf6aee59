// SPDX-License-Identifier: Apache-2.0
// A mesh with one look of one member, drawn alone; used by bake and evaluation.
#pragma once

#include "render/recipe.h"

namespace fourdvt::render {

class PlainFigure {
 public:
  // Errors: as CharacterModel and Appearance.
  static Result<PlainFigure> create(gpu::Device& device, const package::Character& character,
                                    const package::BaseMesh& mesh);
  // Sets the frame to draw, in the base mesh's order: positions per vertex; labels [layer][face], the cameras of the
  // texels.
  void setFrame(gpu::Device& device, std::span<const glm::vec3> positions, std::span<const uint8_t> labels);
  void setLayout(const package::Rendition& rendition) { appearance.setLayout(rendition); }
  // Draws this figure by Recipe::draw, without a scene.
  Status draw(Recipe& recipe, const PictureTextures& picture, const View& view, const RecipeOptions& options,
              gpu::TargetId target) const;

  CharacterModel model;
  Appearance appearance;
};

}  // namespace fourdvt::render

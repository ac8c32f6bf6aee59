// SPDX-License-Identifier: Apache-2.0
// The character's figure as a recipe takes it: one model, whose mesh is that of the shown frame, and the look of each
// track on it; during a fade there are two looks on one cross-faded mesh. Uploads the mesh only when it changes. Does
// NOT choose frames, weights or the placement (the player does), and does NOT draw (render/recipe.h).
#pragma once

#include <array>
#include <optional>
#include <span>

#include "player/parts/shown_frame.h"
#include "render/recipe.h"

namespace fourdvt {

// How the second track's mesh is mixed into the first's.
struct MeshFade {
  float share = 0;     // of the second, 0..1
  glm::vec3 shift{0};  // the second's character frame seen from the first's, as of motion::Entry
};

class FigureComposer {
 public:
  // Errors: GpuFailure.
  Status setMesh(gpu::Device& device, const package::Character& character, const package::BaseMesh& mesh);
  bool hasMesh() const { return model_.has_value(); }
  const render::CharacterModel& model() const { return *model_; }  // if hasMesh()

  void markStale() { stale_ = true; }  // the model's mesh is not that of the tracks
  // Uploads the mesh if it is stale. second: null without a fade.
  void compose(gpu::Device& device, const ShownFrame& first, const ShownFrame* second, const MeshFade& fade);
  // looks: one or two. The figure is valid until the next call.
  render::Figure figure(std::span<const render::Look> looks, float fade, const glm::mat4& world_from_character) const;

 private:
  std::optional<render::CharacterModel> model_;
  bool stale_ = false;
  Positions faded_;  // scratch
  mutable std::array<render::Look, 2> looks_;
};

}  // namespace fourdvt

// SPDX-License-Identifier: Apache-2.0
#include "player/parts/figure_composer.h"

#include <algorithm>

#include "motion/mesh_blend.h"
#include "motion/placement.h"

namespace fourdvt {

Status FigureComposer::setMesh(gpu::Device& device, const package::Character& character,
                               const package::BaseMesh& mesh) {
  auto model = render::CharacterModel::create(device, character, mesh);
  if (!model.ok()) return model.error();
  model_ = model.take();
  return {};
}

void FigureComposer::compose(gpu::Device& device, const ShownFrame& first, const ShownFrame* second,
                             const MeshFade& fade) {
  if (!stale_) return;
  stale_ = false;
  if (!second) {
    model_->setPositions(device, first.positions());
    return;
  }
  faded_ = first.positions();
  const glm::mat4 first_from_second = motion::worldFromCharacter(motion::moved({}, fade.shift));
  motion::crossFade(faded_, second->positions(), first_from_second, fade.share);
  model_->setPositions(device, faded_);
}

render::Figure FigureComposer::figure(std::span<const render::Look> looks, float fade,
                                      const glm::mat4& world_from_character) const {
  std::copy(looks.begin(), looks.end(), looks_.begin());
  render::Figure figure;
  figure.model = &*model_;
  figure.looks = std::span<const render::Look>(looks_.data(), looks.size());
  figure.fade = fade;
  figure.world_from_character = world_from_character;
  return figure;
}

}  // namespace fourdvt

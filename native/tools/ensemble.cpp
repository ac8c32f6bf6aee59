// SPDX-License-Identifier: Apache-2.0
#include "tools/ensemble.h"

#include <algorithm>

namespace fourdvt::tools {

Result<std::unique_ptr<Ensemble>> Ensemble::create(GpuSession& gpu, edge::AlignMethod align) {
  FOURDVT_ASSIGN(std::shared_ptr<render::Recipe> shared, render::Recipe::create(*gpu.device));
  FOURDVT_ASSIGN(auto prepared, edge::prepareAlign(align, *gpu.device, *shared));
  return std::unique_ptr<Ensemble>(new Ensemble(gpu, std::move(shared), prepared));
}

Status Ensemble::add(const edge::ActorOptions& options) {
  FOURDVT_ASSIGN(auto opened, openCharacterOn(gpu_, options.folder, recipe_, options.rendition));
  Actor actor{std::move(opened), options.cues};
  Player& player = actor.character->player();
  const package::Character& character = *player.character();
  const std::string state = options.state.empty() ? character.sequences.front().name : options.state;
  for (const edge::Cue& cue : options.cues)
    if (auto found = edge::findState(character, cue.state, options.folder); !found.ok()) return found.error();
  if (auto found = edge::findState(character, state, options.folder); !found.ok()) return found.error();
  std::stable_sort(actor.cues.begin(), actor.cues.end(),
                   [](const edge::Cue& a, const edge::Cue& b) { return a.at_s < b.at_s; });
  FOURDVT_TRY(edge::setParameters(player, options.parameters, options.folder));
  FOURDVT_TRY(actor.character->showFrame(state, 0));
  player.setPlacement(options.placement);
  player.setTravel(options.travel);
  player.setAlign(align_);
  player.play();
  actors_.push_back(std::move(actor));
  return {};
}

Status Ensemble::followCues(Actor& actor) {
  while (actor.next_cue < actor.cues.size() && actor.cues[actor.next_cue].at_s <= now_s_ + 1e-9)
    FOURDVT_TRY(actor.character->player().goTo(actor.cues[actor.next_cue++].state));
  return {};
}

Status Ensemble::advance(double seconds) {
  for (Actor& actor : actors_) {
    FOURDVT_TRY(followCues(actor));
    FOURDVT_TRY(actor.character->advance(seconds));
  }
  now_s_ += seconds;
  return {};
}

Result<Image> Ensemble::draw(const PinholeCamera& camera, const render::Scene* scene,
                             const render::RecipeOptions& recipe) {
  std::vector<render::Figure> figures;
  for (const Actor& actor : actors_) {
    FOURDVT_ASSIGN(auto figure, actor.character->player().figure());
    figures.push_back(figure);
  }
  const render::View view = render::viewFromCamera(camera, render::lengthScalesOf(figures));
  return still_.render(view, [&](gpu::TargetId target) {
    return recipe_->draw(figures, scene, view, {recipe, align_}, target);
  });
}

}  // namespace fourdvt::tools

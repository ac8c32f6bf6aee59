// SPDX-License-Identifier: Apache-2.0
#include "tools/stage.h"

#include <algorithm>

namespace fourdvt::tools {

Result<std::unique_ptr<Stage>> Stage::create(GpuSession& gpu, AlignMethod align) {
  auto recipe = render::Recipe::create(*gpu.device);
  if (!recipe.ok()) return recipe.error();
  std::shared_ptr<render::Recipe> shared = recipe.take();
  auto prepared = prepareAlign(align, *gpu.device, *shared);
  if (!prepared.ok()) return prepared.error();
  return std::unique_ptr<Stage>(new Stage(gpu, std::move(shared), prepared.value()));
}

Status Stage::add(const ActorOptions& options) {
  auto opened = openCharacterOn(gpu_, options.folder, recipe_);
  if (!opened.ok()) return opened.error();
  Actor actor{opened.take(), options.cues};
  Player& player = actor.character->player();
  const package::Character& character = *player.character();
  const std::string state = options.state.empty() ? character.sequences.front().name : options.state;
  for (const Cue& cue : options.cues)
    if (auto found = findState(character, cue.state, options.folder); !found.ok()) return found.error();
  if (auto found = findState(character, state, options.folder); !found.ok()) return found.error();
  std::stable_sort(actor.cues.begin(), actor.cues.end(), [](const Cue& a, const Cue& b) { return a.at_s < b.at_s; });
  FOURDVT_TRY(setParameters(player, options.parameters, options.folder));
  FOURDVT_TRY(actor.character->showFrame(state, 0));
  player.setPlacement(options.placement);
  player.setTravel(options.travel);
  player.setAlign(align_);
  player.play();
  actors_.push_back(std::move(actor));
  return {};
}

Status Stage::followCues(Actor& actor) {
  while (actor.next_cue < actor.cues.size() && actor.cues[actor.next_cue].at_s <= now_s_ + 1e-9)
    FOURDVT_TRY(actor.character->player().goTo(actor.cues[actor.next_cue++].state));
  return {};
}

Status Stage::advance(double seconds) {
  for (Actor& actor : actors_) {
    FOURDVT_TRY(followCues(actor));
    FOURDVT_TRY(actor.character->advance(seconds));
  }
  now_s_ += seconds;
  return {};
}

Result<Image> Stage::draw(const render::View& view, const render::Scene* scene, const render::RecipeOptions& recipe) {
  std::vector<render::Figure> figures;
  for (const Actor& actor : actors_) {
    auto figure = actor.character->player().figure();
    if (!figure.ok()) return figure.error();
    figures.push_back(figure.value());
  }
  return still_.render(view, [&](gpu::TargetId target) {
    return recipe_->draw(figures, scene, view, {recipe, align_}, target);
  });
}

}  // namespace fourdvt::tools

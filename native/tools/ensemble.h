// SPDX-License-Identifier: Apache-2.0
// Several figures that play and are drawn into one picture. Time passes by the steps that advance() is told.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "edge/scene_file.h"
#include "render/still_target.h"
#include "tools/session.h"

namespace fourdvt::tools {

class Ensemble {
 public:
  // `gpu` outlives the ensemble.
  static Result<std::unique_ptr<Ensemble>> create(GpuSession& gpu, edge::AlignMethod align);
  // Opens a character and shows its first frame. Errors: those of opening; InvalidArgument (unknown state or
  // parameter).
  Status add(const edge::ActorOptions& options);
  // Plays on by this much time, and starts the transitions whose cues are due.
  Status advance(double seconds);
  // `scene` may be null.
  Result<Image> draw(const PinholeCamera& camera, const render::Scene* scene, const render::RecipeOptions& recipe);
  render::Recipe& recipe() { return *recipe_; }
  Player& player(size_t actor) { return actors_[actor].character->player(); }
  size_t count() const { return actors_.size(); }

 private:
  struct Actor {
    std::unique_ptr<edge::CharacterPlayer> character;
    std::vector<edge::Cue> cues;  // in order of time
    size_t next_cue = 0;
  };
  Ensemble(GpuSession& gpu, std::shared_ptr<render::Recipe> recipe, render::Align align)
      : gpu_(gpu), recipe_(std::move(recipe)), align_(align), still_(*gpu.device) {}
  Status followCues(Actor& actor);

  GpuSession& gpu_;
  std::shared_ptr<render::Recipe> recipe_;
  render::Align align_;
  render::StillTarget still_;
  std::vector<Actor> actors_;
  double now_s_ = 0;
};

}  // namespace fourdvt::tools

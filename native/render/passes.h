// SPDX-License-Identifier: Apache-2.0
// The passes of the recipe, in order of execution: shadow cast → [target cleared] → shadow ground → layered.
// Does NOT own the target they draw into (recipe.cpp).
#pragma once

#include <map>

#include "render/recipe.h"

namespace fourdvt::render {

// Embedded NAME.vert and NAME.frag as a program.
Result<gpu::Program> makeEmbeddedProgram(gpu::Device& device, const char* vertex, const char* fragment,
                                         const std::string& defines = {});

// Soft contact shadow: the lowest surface seen from above, as occlusion of the ground, blurred.
class ShadowPass {
 public:
  static Result<ShadowPass> create(gpu::Device& device);
  // Three draws into own targets; nothing if the geometry is that of the last call.
  void cast(gpu::Device& device, const CharacterModel& model);
  // One draw inside the caller's pass: the ground quad, premultiplied.
  void drawGround(gpu::Device& device, const View& view, float strength) const;

 private:
  static constexpr int kSide = 128;  // texels of the occlusion map
  gpu::Program cast_, blur_, ground_;
  gpu::Texture maps_[2];  // RG8: contact, body
  gpu::Target targets_[2];
  glm::vec4 area_{0, 0, 1, 0};  // centre x, centre z, half extent (m), ground y (m)
  uint64_t serial_ = 0;
};

// The character with layered view-dependent texture (LVDT Eq. 3-4). Programs are made on first use, one for each layer
// count, picture kind, debug view and kind of weights.
class LayeredPass {
 public:
  // Makes the program. Errors: GpuFailure.
  Status prepare(gpu::Device& device, const CharacterModel& model, PictureTextures::Kind kind,
                 const RecipeOptions& options);
  // One draw inside the caller's pass, after prepare with the same arguments.
  void draw(gpu::Device& device, const CharacterModel& model, const PictureTextures& picture, const View& view,
            const RecipeOptions& options) const;

 private:
  static int key(const CharacterModel& model, PictureTextures::Kind kind, const RecipeOptions& options);
  std::map<int, gpu::Program> programs_;
};

}  // namespace fourdvt::render

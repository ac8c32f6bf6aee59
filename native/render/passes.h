// SPDX-License-Identifier: Apache-2.0
// The passes of the recipe, in order of execution: shadow cast → [parts → mix, for figures of several parts] → [target
// cleared] → background, scene meshes → shadow ground → layered, or the mesh with its mixed picture.
// Everything of a figure is in its character's frame, the View too. Does NOT own the target they draw into
// (recipe.cpp).
#pragma once

#include <map>
#include <vector>

#include "render/recipe.h"

namespace fourdvt::render {

// Embedded NAME.vert and NAME.frag as a program.
Result<gpu::Program> makeEmbeddedProgram(gpu::Device& device, const char* vertex, const char* fragment,
                                         const std::string& defines = {});

// A member of an appearance, and its share of the blend.
struct Source {
  int member = 0;
  float weight = 1;
};

// What one layered draw shows of a figure.
struct Part {
  const Look* look = nullptr;
  std::vector<Source> sources;  // weights sum 1
  float share = 1;              // of the figure
};

// Parts of positive share, sum 1: the looks, with Align::Flow the members of each. More than one: they are mixed.
std::vector<Part> partsOf(const Figure& figure, const DrawOptions& options);
// Errors: InvalidArgument.
Status checkFigure(const Figure& figure, const RecipeOptions& options);

// In the character's frame.
View viewOfFigure(const View& view, const Figure& figure);

// Soft contact shadows: the lowest surface seen from above, as occlusion of the ground, blurred. A map a figure.
class ShadowPass {
 public:
  static Result<ShadowPass> create(gpu::Device& device);
  // Three draws into own targets; nothing if geometry and ground are those of the last call. `i`: the figure's number.
  Status cast(gpu::Device& device, size_t i, const CharacterModel& model, float ground_y_m);
  // One draw inside the caller's pass: the ground quad, premultiplied, behind what is nearer.
  void drawGround(gpu::Device& device, size_t i, const View& view, float strength) const;

 private:
  static constexpr int kSide = 128;  // texels of the occlusion map
  struct Map {
    gpu::Texture occlusion;  // RG8: contact, body
    gpu::Target target;
    glm::vec4 area{0, 0, 1, 0};  // centre x, centre z, half extent (m), ground y (m)
    uint64_t serial = 0;
  };
  static Result<Map> makeMap(gpu::Device& device, bool with_depth);

  gpu::Program cast_, blur_, ground_;
  Map scratch_;
  std::vector<Map> maps_;
};

// A character with layered view-dependent texture (LVDT Eq. 3-4), up to four members of a look blended. Programs are
// made on first use, one for each layer count, number of sources, picture kind, debug view and kind of weights.
class LayeredPass {
 public:
  // Makes the program. Errors: GpuFailure.
  Status prepare(gpu::Device& device, const CharacterModel& model, const Part& part, const DrawOptions& options);
  // One draw inside the caller's pass, after prepare with the same arguments.
  void draw(gpu::Device& device, const CharacterModel& model, const Part& part, const View& view,
            const DrawOptions& options) const;

 private:
  std::map<uint32_t, gpu::Program> programs_;
};

// Pictures of one mesh and view, and the mesh drawn with one of them.
class MixPass {
 public:
  // Makes the programs. Errors: GpuFailure.
  Status prepare(gpu::Device& device, bool with_flow);
  // One draw over the caller's pass. flow: of first to second; 0: none.
  void mix(gpu::Device& device, gpu::TextureId first, gpu::TextureId second, float share_of_second,
           gpu::TextureId flow) const;
  void drawMesh(gpu::Device& device, const CharacterModel& model, gpu::TextureId picture, const View& view) const;

 private:
  gpu::Program mix_, mix_flow_, mesh_;
};

// Background and meshes of a Scene; programs are made on first use.
class ScenePass {
 public:
  Status prepare(gpu::Device& device);  // Errors: GpuFailure
  void draw(gpu::Device& device, const Scene& scene, const View& view) const;

 private:
  gpu::Program background_, mesh_;
};

}  // namespace fourdvt::render

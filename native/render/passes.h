// SPDX-License-Identifier: Apache-2.0
// Passes of the recipe, in order of execution:
// shadow cast → [figures of several parts: parts → mix; with a style: the figure] → one of
// with a scene: [target cleared] → background, scene meshes → shadow ground → layered, or the mesh with its picture;
// without a scene, if only the figures' region is multisampled: layered, or the mesh with its picture → [canvas
// cleared] → shadow ground → the region's picture.
// Figure data is in the character's frame (CharacterView). The caller (recipe.cpp) owns the target.
#pragma once

#include <map>
#include <vector>

#include "render/figures.h"
#include "render/flow/flow.h"
#include "render/scene.h"

namespace fourdvt::render {

// Makes a program of the embedded files `vertex` and `fragment`.
Result<gpu::Program> makeEmbeddedProgram(gpu::Device& device, const char* vertex, const char* fragment,
                                         const std::string& defines = {});

// A member of an appearance, and its share of the blend.
struct WeightedMember {
  int member = 0;
  float weight = 1;
};

// Part of a figure shown by one layered draw.
struct Part {
  const Look* look = nullptr;
  std::vector<WeightedMember> members;  // weights sum 1
  float share = 1;                      // share of the figure's colour
};

// Returns the parts of a figure's mix: its looks, or with Align::Flow the members of each look. Shares are positive and
// sum to 1; a figure of one part needs no mixing.
std::vector<Part> partsOf(const Figure& figure, const DrawOptions& options);
// Errors: InvalidArgument.
Status checkFigure(const Figure& figure, const RecipeOptions& options);

// Rectangle of the view that holds the figures. Only this is multisampled, if nothing but the background and the
// figures' shadows surrounds it. Its size changes in steps and rarely shrinks, so that targets persist while figures
// and camera move.
class FigureRegion {
 public:
  // all: uses the whole view. Returns true if the size has changed.
  bool update(std::span<const Figure> figures, const View& view, bool all);
  const gpu::Region& region() const { return region_; }  // y from below
  int viewWidth() const { return view_size_[0]; }
  int viewHeight() const { return view_size_[1]; }
  bool isWhole() const { return region_.width == view_size_[0] && region_.height == view_size_[1]; }

 private:
  gpu::Region region_;
  int view_size_[2] = {};  // width, height
  int roomy_draws_ = 0;    // consecutive draws that needed less than half of the region
};

// The view in the frame of the figure's character.
CharacterView viewOfFigure(const View& view, const Figure& figure);

// Soft contact shadows: blurred occlusion of the ground by the lowest surface seen from above. One map per figure.
class ShadowPass {
 public:
  static Result<ShadowPass> create(gpu::Device& device);
  // Draws figure number `i` into its map (three draws); returns early if geometry and ground are unchanged.
  Status cast(gpu::Device& device, size_t i, const CharacterModel& model, float ground_y_m);
  // Draws the shadow on the ground inside the caller's pass: a premultiplied quad, depth-tested if `depth_test` is set.
  void drawGround(gpu::Device& device, size_t i, const CharacterView& view, float strength, bool depth_test) const;

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
  gpu::Program cast_surface_;  // for figures from cameras; made on first use
  Map scratch_;
  std::vector<Map> maps_;
};

// Variant of the programs of LayeredPass.
struct LayeredVariant {
  int layers = 1, members = 1;
  PictureTextures::Kind kind = PictureTextures::Kind::I420;
  DebugView debug = DebugView::None;
  bool aligned = false;
  auto operator<=>(const LayeredVariant&) const = default;
};

// Characters with layered view-dependent texture (LVDT Eq. 3-4), up to four members of a look blended.
class LayeredPass {
 public:
  virtual ~LayeredPass() = default;
  bool has(const LayeredVariant& variant) const { return programs_.contains(variant); }
  // Makes the program on first use. Errors: GpuFailure.
  Status prepare(gpu::Device& device, const LayeredVariant& variant);
  // Makes all draws that precede the part's own pass.
  virtual Status prepare(gpu::Device& device, const CharacterModel& model, const Part& part, const CharacterView& view,
                         const DrawOptions& options);
  // Makes one draw inside the caller's pass, after prepare with the same arguments.
  void draw(gpu::Device& device, const CharacterModel& model, const Part& part, const CharacterView& view,
            const DrawOptions& options) const;

 protected:
  // Makes the program of layered.vert and layered.frag; a subclass may substitute its own.
  virtual Result<gpu::Program> makeProgram(gpu::Device& device, const LayeredVariant& variant,
                                           const std::string& defines) const;
  // Adds the uniforms and textures that a subclass's program requires beyond these; uniform data must outlive the draw.
  virtual void addTo(gpu::Draw& draw, const Part& part) const {}

 private:
  std::map<LayeredVariant, gpu::Program> programs_;
};

// Picture of the figures' region.
struct Canvas {
  gpu::Texture color;
  gpu::Target target;
  // Makes the canvas on first use. Errors: GpuFailure.
  Status prepare(gpu::Device& device, int width, int height);
};

// Mixes the pictures of a figure's parts, and draws the mesh with a mixed picture. In wasm it is loaded after the first
// picture (base/later.h). Order of calls: begin → for each part { draw it alone into canvas() → add }.
class MixPass {
 public:
  bool ready() const { return mix_ && mesh_; }  // programs without flow are made
  // Makes the programs. Errors: GpuFailure.
  Status prepare(gpu::Device& device, bool with_flow);
  // Errors: GpuFailure.
  Status begin(gpu::Device& device, bool with_flow, int width, int height);
  const Canvas& canvas() const { return parts_[share_ > 0]; }
  // Mixes the part into `out`, with the mixture of the parts before it. Parts come in the order of looks and members,
  // so that the picture changes smoothly with their shares. flow: null, or aligns the part with the mixture. Errors:
  // GpuFailure.
  Status add(gpu::Device& device, const Part& part, FlowSource* flow, int width, int height, Canvas& out);
  void drawMesh(gpu::Device& device, const CharacterModel& model, gpu::TextureId picture,
                const CharacterView& view) const;
  void release() {  // frees pictures of a size other than the next
    for (Canvas& part : parts_) part = {};
  }

 private:
  gpu::Program mix_, mix_flow_, mesh_;
  Canvas parts_[2];  // scratch: the mixture or the first part, and the next part
  float share_ = 0;  // accumulated share of the mixture
  bool mixed_ = false;
};

// Draws background and meshes of a Scene; programs are made on first use.
class ScenePass {
 public:
  Status prepare(gpu::Device& device);  // Errors: GpuFailure
  void draw(gpu::Device& device, const Scene& scene, const View& view) const;

 private:
  gpu::Program background_, mesh_;
};

}  // namespace fourdvt::render

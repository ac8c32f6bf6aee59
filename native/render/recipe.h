// SPDX-License-Identifier: Apache-2.0
// The frame recipe: background → scene → ground shadows → characters → resolve; without a scene: characters in their
// region of the view → resolve → background → ground shadows → that region. Same calls natively and in the browser.
// Several figures share programs and targets.
#pragma once

#include <memory>

#include "gpu/device.h"
#include "render/appearance.h"
#include "render/flow/flow.h"
#include "render/method.h"
#include "render/scene.h"
#include "render/style.h"
#include "render/view.h"

namespace fourdvt::render {

enum class DebugView { None, Labels, Layer, Weights, Normals };

struct RecipeOptions {
  glm::vec4 background{0, 0, 0, 0};  // premultiplied sRGB-encoded; alpha 0: the page shows through
  bool ground_shadow = true;         // soft contact shadow on the ground plane, premultiplied black
  float shadow_strength = 0.45f;     // opacity directly under the feet, 0..1
  int samples = 4;                   // multisampling of the character; clamped to the device's maximum
  DebugView debug = DebugView::None;
  int debug_layer = 0;      // of DebugView::Layer and Labels; the last one where a figure has fewer
  bool keep_detail = true;  // gives aligned blends back the contrast that their mean loses
  // Of the blend's two cosines: how squarely a camera sees the surface, and how near it is to the view. 1: LVDT Eq. 3.
  float facing_exponent = 2, view_exponent = 2;
};

// How the members' appearance is brought together (4DVT 5). None: plain blend. Baked: texture coordinates move by the
// stream's alignment, no extra pass. Flow: every member is drawn on the same mesh and view, aligned by optical flow in
// the picture, warped and blended (4DVT Eq. 7 corrected, algorithms/alignment.md); more than two one after the other,
// each to the blend of those before it, so that nothing jumps where weights cross.
enum class Align { None, Baked, Flow };

// One decoded picture on the figure's mesh.
struct Look {
  const Appearance* appearance = nullptr;
  const PictureTextures* picture = nullptr;
  std::span<const float> weights;  // one per member, sum 1; below 1/512 a member is not drawn
};

struct Figure {
  const CharacterModel* model = nullptr;
  std::span<const Look> looks;  // one; two during a transition
  float fade = 0;               // 0: the first look, 1: the second
  glm::mat4 world_from_character{1};
  const CameraLook* cameras = nullptr;  // of a character from cameras, in place of looks
};

// Those of the models; 1 without figures.
LengthScales lengthScalesOf(std::span<const Figure> figures);

struct DrawOptions {
  RecipeOptions recipe;
  Align align = Align::Baked;
  MethodOptions method;
};

class LayeredPass;  // render/passes.h

class Recipe {
 public:
  static Result<std::unique_ptr<Recipe>> create(gpu::Device& device);
  virtual ~Recipe() = default;
  // Draws one picture of the figures, nearest surface first by depth. Output is premultiplied, sRGB-encoded,
  // view.width × view.height at (0,0) of `target` (gpu::kDefaultTarget: the canvas). Intermediate targets are kept and
  // resized on demand. scene: null: none. Errors: InvalidArgument, GpuFailure; Unsupported: Align::Flow without a flow,
  // a figure from cameras without a method.
  virtual Status draw(std::span<const Figure> figures, const Scene* scene, const View& view, const DrawOptions& options,
                      gpu::TargetId target) = 0;
  // Makes one of the programs that pictures of a character will need and that are not there yet: of blends of up to
  // `most_members` members (`aligned`: their appearance says how they are aligned), and of cross-fades. False: all are
  // there. Without this a program is made when a picture needs it first, which a visitor notices. Those of Align::Flow
  // are left to that. Errors: GpuFailure.
  virtual Result<bool> makeNextProgram(int layer_count, int most_members, bool aligned, PictureTextures::Kind kind,
                                       const DrawOptions& options) = 0;
  // What Align::Flow uses; null: none. See flow.h.
  virtual void setFlow(std::unique_ptr<FlowSource> flow) = 0;
  // What draws figures from cameras; null: none.
  virtual void setMethod(std::unique_ptr<Method> method) = 0;
  // In what style the figures are drawn; null: as they are.
  void setStyle(std::unique_ptr<FigureStyle> style) { style_ = std::move(style); }
  FigureStyle* style() { return style_.get(); }
  // What draws layered figures; null: the plain blend.
  void setLayered(std::shared_ptr<LayeredPass> layered) { layered_ = std::move(layered); }
  bool hasLayered() const { return layered_ != nullptr; }

 protected:
  std::shared_ptr<LayeredPass> layered_;
  std::unique_ptr<FigureStyle> style_;
};

}  // namespace fourdvt::render

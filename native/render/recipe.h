// SPDX-License-Identifier: Apache-2.0
// Frame recipe: background → scene → ground shadows → characters → resolve; without a scene: characters in their region
// of the view → resolve → background → ground shadows → that region. The calls are the same natively and in the
// browser. Figures share programs and targets.
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
  glm::vec4 background{0, 0, 0, 0};  // premultiplied sRGB-encoded; alpha 0: the page is visible behind
  bool ground_shadow = true;         // soft contact shadow on the ground plane, premultiplied black
  float shadow_strength = 0.45f;     // opacity at ground contact, 0..1
  int samples = 4;                   // multisampling of the character; clamped to the device's maximum
  DebugView debug = DebugView::None;
  int debug_layer = 0;      // layer of DebugView::Layer and Labels; clamped to the figure's last
  bool keep_detail = true;  // restores the contrast that aligned blends lose in their mean
  // Exponents of the blend's two cosines: surface normal to camera ray, and camera ray to view ray. 1: LVDT Eq. 3.
  float facing_exponent = 2, view_exponent = 2;
};

// Alignment of the members' appearance (4DVT 5: Dan Casas, Marco Volino, John Collomosse, Adrian Hilton: 4D Video
// Textures for Interactive Character Appearance. Computer Graphics Forum 33(2) (Eurographics), 2014). None: plain
// blend. Baked: texture coordinates are displaced by the stream's alignment, no extra pass. Flow: every member is drawn
// on the same mesh and view, aligned by optical flow in the picture, warped and blended (4DVT Eq. 7 corrected,
// algorithms/alignment.md); more than two in sequence, each to the blend of those before it, which keeps the picture
// continuous where weights cross.
enum class Align { None, Baked, Flow };

// One decoded picture on the figure's mesh.
struct Look {
  const Appearance* appearance = nullptr;
  const PictureTextures* picture = nullptr;
  std::span<const float> weights;  // one per member, sum 1; members below 1/512 are skipped
};

struct Figure {
  const CharacterModel* model = nullptr;
  std::span<const Look> looks;  // one; two during a transition
  float fade = 0;               // 0: the first look, 1: the second
  glm::mat4 world_from_character{1};
  const CameraLook* cameras = nullptr;  // replaces looks for characters from cameras
};

// Returns the range of the models' length scales; 1 without figures.
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
  // Draws one picture of the figures, depth-tested. Output is premultiplied, sRGB-encoded, view.width × view.height at
  // (0,0) of `target` (gpu::kDefaultTarget: the canvas). Intermediate targets persist and are resized on demand. scene:
  // may be null. Errors: InvalidArgument, GpuFailure; Unsupported: Align::Flow without a flow, a figure from cameras
  // without a method.
  virtual Status draw(std::span<const Figure> figures, const Scene* scene, const View& view, const DrawOptions& options,
                      gpu::TargetId target) = 0;
  // Compiles one missing program that pictures of a character will require: blends of up to `max_members` members
  // (`aligned`: their appearance has alignment), and cross-fades. Returns false if none is missing. Otherwise programs
  // compile on first use, which causes a visible stall. Excludes programs of Align::Flow. Errors: GpuFailure.
  virtual Result<bool> makeNextProgram(int layer_count, int max_members, bool aligned, PictureTextures::Kind kind,
                                       const DrawOptions& options) = 0;
  // Sets the flow for Align::Flow; may be null (flow.h).
  virtual void setFlow(std::unique_ptr<FlowSource> flow) = 0;
  // Sets the method that draws figures from cameras; may be null.
  virtual void setMethod(std::unique_ptr<Method> method) = 0;
  // Sets the style of the figures; null: unstyled.
  void setStyle(std::unique_ptr<FigureStyle> style) { style_ = std::move(style); }
  FigureStyle* style() { return style_.get(); }
  // Sets the pass for layered figures; null: the plain blend.
  void setLayered(std::shared_ptr<LayeredPass> layered) { layered_ = std::move(layered); }
  bool hasLayered() const { return layered_ != nullptr; }

 protected:
  std::shared_ptr<LayeredPass> layered_;
  std::unique_ptr<FigureStyle> style_;
};

}  // namespace fourdvt::render

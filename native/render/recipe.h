// SPDX-License-Identifier: Apache-2.0
// Frame recipe: background → scene → ground shadows → characters → resolve; without a scene: characters in their region
// of the view → resolve → background → ground shadows → that region. The calls are the same natively and in the
// browser. Figures share programs and targets.
#pragma once

#include <memory>

#include "gpu/device.h"
#include "render/flow/flow.h"
#include "render/passes.h"
#include "render/scene.h"
#include "render/style.h"

namespace fourdvt::render {

class Recipe {
 public:
  static Result<std::unique_ptr<Recipe>> create(gpu::Device& device);
  // Draws one picture of the figures, depth-tested. Output is premultiplied, sRGB-encoded, view.width × view.height at
  // (0,0) of `target` (gpu::kDefaultTarget: the canvas). Intermediate targets persist and are resized on demand. scene:
  // may be null. Errors: InvalidArgument, GpuFailure; Unsupported: Align::Flow without a flow, a figure from cameras
  // without a method.
  Status draw(std::span<const Figure> figures, const Scene* scene, const View& view, const DrawOptions& options,
              gpu::TargetId target);
  // Compiles one missing program that pictures of a character will require: blends of up to `max_members` members
  // (`aligned`: their appearance has alignment), and cross-fades. Returns false if none is missing. Programs not made
  // in advance compile on first use, which causes a visible stall. Excludes programs of Align::Flow. Errors:
  // GpuFailure.
  Result<bool> makeNextProgram(int layer_count, int max_members, bool aligned, PictureTextures::Kind kind,
                               const DrawOptions& options);
  // Sets the flow for Align::Flow; may be null (flow.h).
  void setFlow(std::unique_ptr<FlowSource> flow) { flow_ = std::move(flow); }
  // Sets the method that draws figures from cameras; may be null.
  void setMethod(std::unique_ptr<Method> method) { method_ = std::move(method); }
  // Sets the style of the figures; null: unstyled.
  void setStyle(std::unique_ptr<FigureStyle> style) { style_ = std::move(style); }
  FigureStyle* style() { return style_.get(); }
  // Sets the pass for layered figures; null: the plain blend.
  void setLayered(std::shared_ptr<LayeredPass> layered) { layered_ = std::move(layered); }
  bool hasLayered() const { return layered_ != nullptr; }

 private:
  struct PlannedFigure;

  Recipe(gpu::Device& device, ShadowPass shadow, gpu::Program over)
      : device_(device), shadow_(std::move(shadow)), over_(std::move(over)) {}
  LayeredPass& layered() { return layered_ ? *layered_ : plain_; }
  const gpu::Region& region() const { return region_.region(); }
  Status check(std::span<const Figure> figures, const View& view, const DrawOptions& options) const;
  // Makes the targets of the figures' region on first use. Scenes require the whole view; so does flow, which depends
  // on the size of its pictures.
  Status fit(std::span<const Figure> figures, const Scene* scene, const View& view, const DrawOptions& options);
  // Makes all draws that precede the main pass.
  Status prepareFigure(PlannedFigure& figure, size_t number, const DrawOptions& options);
  // Begins a pass in the multisampled target of the view's region.
  void beginMain(const glm::vec4& color, const char* label);
  // Multisamples the part like the figure, so that both cover the same pixels.
  void drawAlone(const PlannedFigure& figure, size_t number, const Part* part, const Canvas& out,
                 const DrawOptions& options);
  // part: null for figures from cameras.
  void drawPart(const PlannedFigure& figure, size_t number, const Part* part, const DrawOptions& options);
  void drawFigure(const PlannedFigure& figure, size_t number, const DrawOptions& options);
  void drawShadows(const std::vector<PlannedFigure>& plan, const RecipeOptions& recipe);
  // Draws background and shadows without multisampling, then the figures over them: shadows are soft, and only figures
  // occlude them. Multisampled targets cannot be blitted to another position, hence the intermediate picture.
  void putOver(const std::vector<PlannedFigure>& plan, const RecipeOptions& recipe, gpu::TargetId target);

  gpu::Device& device_;
  ShadowPass shadow_;
  gpu::Program over_;
  std::shared_ptr<LayeredPass> layered_;  // replaces plain_
  LayeredPass plain_;
  MixPass mix_;
  ScenePass scene_pass_;
  std::unique_ptr<FlowSource> flow_;
  std::unique_ptr<Method> method_;
  std::unique_ptr<FigureStyle> style_;
  FigureRegion region_;
  int samples_ = 0;
  gpu::Target main_;
  Canvas resolved_;               // the region's picture; unused for the whole view
  std::vector<Canvas> pictures_;  // indexed by figure
};

}  // namespace fourdvt::render

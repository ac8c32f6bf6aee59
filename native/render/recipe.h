// SPDX-License-Identifier: Apache-2.0
// The frame recipe: ground shadow → layered character → resolve. Same calls natively and in the browser.
#pragma once

#include <memory>

#include "gpu/device.h"
#include "render/character_model.h"
#include "render/view.h"

namespace fourdvt::render {

enum class DebugView { None, Labels, Layer, Weights, Normals };

struct RecipeOptions {
  glm::vec4 background{0, 0, 0, 0};  // premultiplied sRGB-encoded; alpha 0: the page shows through
  bool ground_shadow = true;         // soft contact shadow on the ground plane, premultiplied black
  float shadow_strength = 0.45f;     // opacity directly under the feet, 0..1
  int samples = 4;                   // multisampling of the character; clamped to the device's maximum
  DebugView debug = DebugView::None;
  int debug_layer = 0;
  // LVDT's own protocol: optical axes instead of per-fragment rays, no feathering. For reproduction only.
  bool paper_weights = false;
  float view_exponent = 1;  // sharpens the blend towards the cameras nearest to the view; 1: LVDT Eq. 3
};

class Recipe {
 public:
  static Result<std::unique_ptr<Recipe>> create(gpu::Device& device);
  virtual ~Recipe() = default;
  // Draws one picture of the model. Output is premultiplied, sRGB-encoded, view.width × view.height at (0,0) of
  // `target` (gpu::kDefaultTarget: the canvas). Intermediate targets are kept and resized on demand.
  virtual Status draw(const CharacterModel& model, const PictureTextures& picture, const View& view,
                      const RecipeOptions& options, gpu::TargetId target) = 0;
};

}  // namespace fourdvt::render

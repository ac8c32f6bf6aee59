// SPDX-License-Identifier: Apache-2.0
// A figure to draw, and the options of its drawing (recipe.h).
#pragma once

#include "render/appearance.h"
#include "render/method.h"
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

}  // namespace fourdvt::render

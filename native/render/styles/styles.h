// SPDX-License-Identifier: Apache-2.0
// Styles of figures (M4D 6), for every kind of character and after every method: stippled, or relit. Both draw a
// figure's finished picture in one pass and keep its silhouette.
#pragma once

#include "render/recipe.h"
#include "render/styles/light.h"

namespace fourdvt::render {

enum class StyleKind {
  Sketch,  // grey dots that gather on the dark sides of edges (M4D 6.1)
  Relit,   // brightened or darkened by the light at the normal in the viewer's frame (M4D 6.2, M4D Eq. 6-8)
};

struct StyleOptions {
  StyleKind kind = StyleKind::Sketch;
  float strength = 1;  // 0: unstyled, 1: full style
  Light light = studioLight();
  float light_turn_rad = 0;  // rotation of the light about the vertical, clockwise seen from above
};

// Sets the recipe's style for its next draws; makes programs on first use of a style. Errors: GpuFailure;
// InvalidArgument: strength outside 0..1.
Status setStyle(gpu::Device& device, Recipe& recipe, const StyleOptions& options);

}  // namespace fourdvt::render

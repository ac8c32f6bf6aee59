// SPDX-License-Identifier: Apache-2.0
// The styles of figures (M4D 6), for every kind of character and after every method: sketched in dots, or
// lit anew. Both draw a figure's finished picture in one pass and keep its silhouette.
#pragma once

#include "render/recipe.h"
#include "render/styles/light.h"

namespace fourdvt::render {

enum class StyleKind {
  Sketch,  // grey dots that gather where the picture has dark sides of edges (M4D 6.1)
  Relit,   // brightened or darkened by the light at the normal, as the viewer sees it (M4D 6.2, M4D Eq. 6-8)
};

struct StyleOptions {
  StyleKind kind = StyleKind::Sketch;
  float strength = 1;  // 0: as the figure is, 1: all of the style
  Light light = studioLight();
  float light_turn_rad = 0;  // the light's turn about the vertical, clockwise seen from above
};

// From now on the recipe draws its figures so. Makes programs when a style is used first. Errors: GpuFailure;
// InvalidArgument: a strength outside of 0..1.
Status setStyle(gpu::Device& device, Recipe& recipe, const StyleOptions& options);

}  // namespace fourdvt::render

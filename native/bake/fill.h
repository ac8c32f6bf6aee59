// SPDX-License-Identifier: Apache-2.0
// Every texel of every layer gets a value before encoding (ALGORITHMS 2): holes inside charts of layers >= 2 from
// layer 1 plus the smooth difference of the two layers, gutters with true content from across the chart seam, the rest
// by push-pull. The gutter map depends on the UV topology only and is computed once.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"

namespace fourdvt::bake {

// A texel outside all charts and where its content lies: (x, y) in texels, centres at +0.5.
struct GutterTexel {
  uint32_t texel;  // y * size + x
  float source_x, source_y;
};

struct GutterMap {
  int size = 0;
  std::vector<uint8_t> inside;  // size × size: 1 where the texel's centre lies in a chart
  std::vector<GutterTexel> texels;
};

// `gutter_texels`: width of the gutter in texels of this size. Edges without a partner across the seam (mesh borders)
// have no gutter.
GutterMap makeGutterMap(const MeshTopology& topology, int size, float gutter_texels);

// layers: RGBA, square; alpha 255 = resampled, 0 = empty. Layer 0 may be larger than the others (a multiple).
// maps[l].size is the size of layers[l]. On return all alpha are 255 unless a layer and layer 0 were wholly empty.
void fillLayers(const std::vector<const GutterMap*>& maps, std::vector<Image>& layers);

}  // namespace fourdvt::bake

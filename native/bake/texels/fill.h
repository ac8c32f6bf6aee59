// SPDX-License-Identifier: Apache-2.0
// Fills every texel of every layer before encoding (algorithms/texels.md). Holes inside charts: in layers >= 2 from
// layer 1, in layer 1 from the layers that have the texel, plus the smooth difference of both layers; texels that are
// empty in all layers by diffusion over the mesh, so that charts which are neighbours in UV only do not bleed into each
// other. Gutters: true content from across the chart seam. All other texels: push-pull.
// The smooth difference is that of the hole's border, so that a hole's content meets its surroundings without a step
// where the two layers differ smoothly; where they differ in detail (a highlight, a misregistered stripe) a step of
// that detail's size remains. The gutter map depends on the UV topology only and is computed once.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"

namespace fourdvt::bake {

// A texel outside all charts, and its source (x, y), in texels with centres at +0.5.
struct GutterTexel {
  uint32_t texel;  // y * size + x
  float source_x, source_y;
};

struct GutterMap {
  int size = 0;
  std::vector<uint8_t> inside;  // size × size: 1 where the texel's centre lies in a chart
  std::vector<GutterTexel> texels;
  // The surface under the charts, for holes that no camera sees.
  std::vector<uint32_t> faces;                    // size × size: the texel's face, where inside
  std::vector<std::array<glm::vec2, 3>> corners;  // per face, in texels
  std::vector<glm::uvec3> vertices;               // per face
  std::vector<std::pair<uint32_t, uint32_t>> edges;
  uint32_t vertex_count = 0;
};

// `gutter_texels`: width of the gutter in texels of this size. A gutter texel's source is the end of a straight walk
// over the unfolded surface: across the seam, on through the neighbour's triangles and over further seams. Where the
// walk meets a mesh border, and beyond mesh borders themselves, there is no source: push-pull extrapolates the chart.
GutterMap makeGutterMap(const MeshTopology& topology, int size, float gutter_texels);

// layers: RGBA, square; alpha 255 = resampled, 0 = empty. Layer 0 may be larger than the others (a multiple).
// maps[l].size is the size of layers[l]. On return all alpha are 255 unless a layer and layer 0 were wholly empty.
void fillLayers(const std::vector<const GutterMap*>& maps, std::vector<Image>& layers);

// Push-pull interpolation: a smooth field through scattered valid texels (algorithms/texels.md).
// `field`: size × size texels, xyz = value × weight, w = weight (0 unknown, 1 known). On return every texel with w <
// 1 has been blended towards coarser levels; w is 1 everywhere unless all texels were unknown. size is even.
void pushPull(std::vector<glm::vec4>& field, int size);

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
#include "bake/fill.h"

#include <algorithm>
#include <cmath>

#include "bake/push_pull.h"

namespace fourdvt::bake {
namespace {

using Field = std::vector<glm::vec4>;  // xyz = value × weight (0..255), w = weight

glm::vec4 texelOf(const uint8_t* p) { return p[3] ? glm::vec4(p[0], p[1], p[2], 1) : glm::vec4(0); }

void store(const glm::vec4& value, uint8_t* p) {
  if (value.w <= 0) return;
  for (int c = 0; c < 3; ++c) p[c] = static_cast<uint8_t>(std::clamp(value[c] / value.w + 0.5f, 0.0f, 255.0f));
  p[3] = 255;
}

// Bilinear over the known texels of charts; w is the known share of the footprint.
glm::vec4 sampleCharts(const Image& layer, const std::vector<uint8_t>& inside, float x, float y) {
  const float fx = x - 0.5f, fy = y - 0.5f;
  const int x0 = int(std::floor(fx)), y0 = int(std::floor(fy));
  glm::vec4 sum(0);
  for (int k = 0; k < 4; ++k) {
    const int tx = x0 + (k & 1), ty = y0 + (k >> 1);
    if (tx < 0 || ty < 0 || tx >= layer.width || ty >= layer.height) continue;
    if (!inside[static_cast<size_t>(ty) * layer.width + tx]) continue;
    const float weight = (k & 1 ? fx - x0 : 1 - (fx - x0)) * (k >> 1 ? fy - y0 : 1 - (fy - y0));
    sum += weight * texelOf(layer.at(tx, ty));
  }
  return sum;
}

void fillGutters(const GutterMap& map, Image& layer) {
  for (const GutterTexel& g : map.texels)
    store(sampleCharts(layer, map.inside, g.source_x, g.source_y), layer.pixels.data() + size_t(g.texel) * 4);
}

void fillRest(Image& layer) {
  Field field(static_cast<size_t>(layer.width) * layer.height);
  for (size_t i = 0; i < field.size(); ++i) field[i] = texelOf(&layer.pixels[i * 4]);
  pushPull(field, layer.width);
  for (size_t i = 0; i < field.size(); ++i)
    if (layer.pixels[i * 4 + 3] == 0) store(field[i], &layer.pixels[i * 4]);
}

// Layer 1 at another layer's size: box mean of its texels (all filled).
Image shrink(const Image& layer, int size) {
  const int factor = layer.width / size;
  if (factor == 1) return layer;
  Image out(size, size, 4);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      int sum[4] = {0, 0, 0, 0};
      for (int dy = 0; dy < factor; ++dy)
        for (int dx = 0; dx < factor; ++dx)
          for (int c = 0; c < 4; ++c) sum[c] += layer.at(x * factor + dx, y * factor + dy)[c];
      for (int c = 0; c < 4; ++c)
        out.at(x, y)[c] = static_cast<uint8_t>((sum[c] + factor * factor / 2) / (factor * factor));
    }
  }
  return out;
}

// Holes inside charts take layer 1 shifted by the smooth difference of the two layers, so that brightness and colour
// match where the hole begins.
void fillFromFirst(const GutterMap& map, const Image& first, Image& layer) {
  Field difference(map.inside.size(), glm::vec4(0));
  for (size_t i = 0; i < difference.size(); ++i) {
    const uint8_t *p = &layer.pixels[i * 4], *q = &first.pixels[i * 4];
    if (p[3]) difference[i] = glm::vec4(p[0] - q[0], p[1] - q[1], p[2] - q[2], 1);
  }
  pushPull(difference, map.size);
  for (size_t i = 0; i < difference.size(); ++i) {
    uint8_t* p = &layer.pixels[i * 4];
    if (p[3] || !map.inside[i]) continue;
    const uint8_t* q = &first.pixels[i * 4];
    const glm::vec4 d = difference[i].w > 0 ? difference[i] / difference[i].w : glm::vec4(0, 0, 0, 1);
    store(glm::vec4(q[0] + d.x, q[1] + d.y, q[2] + d.z, 1), p);
  }
}

}  // namespace

void fillLayers(const std::vector<const GutterMap*>& maps, std::vector<Image>& layers) {
  // Layer 1: gutters first, so that holes at a seam are filled from both sides; then gutters again, now of filled
  // charts.
  fillGutters(*maps[0], layers[0]);
  fillRest(layers[0]);
  fillGutters(*maps[0], layers[0]);
  Image first;
  for (size_t l = 1; l < layers.size(); ++l) {
    if (first.width != layers[l].width) first = shrink(layers[0], layers[l].width);
    fillFromFirst(*maps[l], first, layers[l]);
    fillGutters(*maps[l], layers[l]);
    fillRest(layers[l]);
  }
}

}  // namespace fourdvt::bake

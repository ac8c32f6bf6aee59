// SPDX-License-Identifier: Apache-2.0
#include "bake/texels/fill.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::bake {
namespace {

constexpr float kMinTexels = 0.5f;  // minimum weight of known texels for a vertex colour
constexpr int kRelaxations = 60;

using Field = std::vector<glm::vec4>;  // xyz = value × weight (0..255), w = weight

glm::vec4 texelOf(const uint8_t* p) { return p[3] ? glm::vec4(p[0], p[1], p[2], 1) : glm::vec4(0); }

void store(const glm::vec4& value, uint8_t* p) {
  if (value.w <= 0) return;
  for (int c = 0; c < 3; ++c) p[c] = static_cast<uint8_t>(std::clamp(value[c] / value.w + 0.5f, 0.0f, 255.0f));
  p[3] = 255;
}

// Samples bilinearly over the known texels of charts; w is the known share of the footprint.
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

// Downsamples layer 1, all filled, to another layer's size: the mean of the texels in each box.
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

// Downsamples layer 1 to another layer's size: the mean of the known texels in each box.
Image shrinkKnown(const Image& layer, int size) {
  const int factor = layer.width / size;
  if (factor == 1) return layer;
  Image out(size, size, 4);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      glm::vec4 sum(0);
      for (int dy = 0; dy < factor; ++dy)
        for (int dx = 0; dx < factor; ++dx) sum += texelOf(layer.at(x * factor + dx, y * factor + dy));
      store(sum, out.at(x, y));
    }
  }
  return out;
}

// target - source where both are known, extrapolated smoothly; unknown everywhere if no texel is known in both.
Field smoothDifference(const Image& target, const Image& source) {
  Field difference(static_cast<size_t>(target.width) * target.height, glm::vec4(0));
  for (size_t i = 0; i < difference.size(); ++i) {
    const uint8_t *p = &target.pixels[i * 4], *q = &source.pixels[i * 4];
    if (p[3] && q[3]) difference[i] = glm::vec4(p[0] - q[0], p[1] - q[1], p[2] - q[2], 1);
  }
  pushPull(difference, target.width);
  return difference;
}

// Fills holes inside charts from layer 1 where it is known, shifted by the smooth difference of the two layers, so
// that brightness and colour match at the hole's border.
void fillFromFirst(const GutterMap& map, const Image& first, Image& layer) {
  const Field difference = smoothDifference(layer, first);
  for (size_t i = 0; i < difference.size(); ++i) {
    uint8_t* p = &layer.pixels[i * 4];
    const uint8_t* q = &first.pixels[i * 4];
    if (p[3] || !q[3] || !map.inside[i]) continue;
    const glm::vec4 d = difference[i].w > 0 ? difference[i] / difference[i].w : glm::vec4(0, 0, 0, 1);
    store(glm::vec4(q[0] + d.x, q[1] + d.y, q[2] + d.z, 1), p);
  }
}

// Fills holes of layer 1 from a further layer that covers them, shifted likewise by the smooth difference: a camera
// that sees the texel is a better source than neighbours in UV space.
void fillFirstFrom(const GutterMap& first_map, const GutterMap& map, const Image& layer, Image& first) {
  const Field difference = smoothDifference(shrinkKnown(first, layer.width), layer);
  const float scale = float(layer.width) / float(first.width);
  for (int y = 0; y < first.height; ++y) {
    for (int x = 0; x < first.width; ++x) {
      uint8_t* p = first.at(x, y);
      if (p[3] || !first_map.inside[static_cast<size_t>(y) * first.width + x]) continue;
      const float sx = (float(x) + 0.5f) * scale, sy = (float(y) + 0.5f) * scale;
      const glm::vec4 q = sampleCharts(layer, map.inside, sx, sy);
      const glm::vec4& d = difference[static_cast<size_t>(sy) * layer.width + static_cast<size_t>(sx)];
      if (q.w < 0.25f || d.w <= 0) continue;
      store(glm::vec4(glm::vec3(q) / q.w + glm::vec3(d) / d.w, 1), p);
    }
  }
}

glm::vec3 barycentric(const std::array<glm::vec2, 3>& p, glm::vec2 at) {
  const auto cross2 = [](glm::vec2 u, glm::vec2 v) { return u.x * v.y - u.y * v.x; };
  const float area = cross2(p[1] - p[0], p[2] - p[0]);
  if (area == 0) return glm::vec3(1.0f / 3);
  const float b = cross2(at - p[0], p[2] - p[0]) / area, c = cross2(p[1] - p[0], at - p[0]) / area;
  return {1 - b - c, b, c};
}

// Colours at the mesh's vertices: sampled from known texels, spread ring by ring to vertices without any and relaxed
// there (a membrane over the mesh). w = 0: the connected component has no known texel.
Field vertexColours(const GutterMap& map, const Image& layer) {
  Field colours(map.vertex_count, glm::vec4(0));
  for (size_t i = 0; i < map.inside.size(); ++i) {
    if (!map.inside[i] || !layer.pixels[4 * i + 3]) continue;
    const uint32_t f = map.faces[i];
    const glm::vec3 w = barycentric(map.corners[f], {float(i % map.size) + 0.5f, float(i / map.size) + 0.5f});
    for (int k = 0; k < 3; ++k) colours[map.vertices[f][k]] += std::max(w[k], 0.0f) * texelOf(&layer.pixels[4 * i]);
  }
  std::vector<uint8_t> known(colours.size());
  for (size_t v = 0; v < colours.size(); ++v) {
    known[v] = colours[v].w > kMinTexels;
    colours[v] = known[v] ? colours[v] / colours[v].w : glm::vec4(0);
  }
  Field sums(colours.size());
  size_t coloured = 0;
  for (int relaxation = 0; relaxation < kRelaxations;) {
    std::fill(sums.begin(), sums.end(), glm::vec4(0));
    for (const auto& [a, b] : map.edges) sums[a] += colours[b], sums[b] += colours[a];
    size_t count = 0;
    for (size_t v = 0; v < colours.size(); ++v) {
      if (!known[v] && sums[v].w > 0) colours[v] = sums[v] / sums[v].w;
      count += colours[v].w > 0;
    }
    if (count == coloured) ++relaxation;
    coloured = count;
  }
  return colours;
}

// Fills holes inside charts that no camera sees with vertex colours, shifted by the smooth difference to the known
// texels.
void fillOnSurface(const GutterMap& map, Image& layer) {
  const Field vertices = vertexColours(map, layer);
  Image smooth(map.size, map.size, 4);
  for (size_t i = 0; i < map.inside.size(); ++i) {
    if (!map.inside[i]) continue;
    const uint32_t f = map.faces[i];
    const glm::vec3 w = barycentric(map.corners[f], {float(i % map.size) + 0.5f, float(i / map.size) + 0.5f});
    glm::vec4 sum(0);
    for (int k = 0; k < 3; ++k) sum += std::max(w[k], 0.0f) * vertices[map.vertices[f][k]];
    store(sum, &smooth.pixels[4 * i]);
  }
  fillFromFirst(map, smooth, layer);
}

}  // namespace

void fillLayers(const std::vector<const GutterMap*>& maps, std::vector<Image>& layers) {
  for (size_t l = 1; l < layers.size(); ++l) fillFirstFrom(*maps[0], *maps[l], layers[l], layers[0]);
  fillOnSurface(*maps[0], layers[0]);
  fillGutters(*maps[0], layers[0]);
  fillRest(layers[0]);
  Image first;
  for (size_t l = 1; l < layers.size(); ++l) {
    if (first.width != layers[l].width) first = shrink(layers[0], layers[l].width);
    fillFromFirst(*maps[l], first, layers[l]);
    fillGutters(*maps[l], layers[l]);
    fillRest(layers[l]);
  }
}

namespace {

struct Level {
  int size;
  std::vector<glm::vec4> texels;
};

// The mean of up to four children; the weight saturates at 1.
void push(const std::vector<glm::vec4>& fine, int fine_size, Level& coarse) {
  coarse.size = (fine_size + 1) / 2;
  coarse.texels.resize(static_cast<size_t>(coarse.size) * coarse.size);
  for (int y = 0; y < coarse.size; ++y) {
    const glm::vec4* row0 = &fine[static_cast<size_t>(2 * y) * fine_size];
    const glm::vec4* row1 = 2 * y + 1 < fine_size ? row0 + fine_size : row0;
    for (int x = 0; x < coarse.size; ++x) {
      const int x0 = 2 * x, x1 = std::min(2 * x + 1, fine_size - 1);
      const glm::vec4 sum = row0[x0] + row0[x1] + row1[x0] + row1[x1];
      coarse.texels[static_cast<size_t>(y) * coarse.size + x] = sum.w > 1 ? sum / sum.w : sum;
    }
  }
}

// Bilinear (1/4, 3/4) sample of the coarse level at fine texel (x, y).
glm::vec4 sample(const Level& coarse, int x, int y) {
  const int last = coarse.size - 1;
  const int cx = std::min(x / 2, last), cy = std::min(y / 2, last);
  const int nx = std::clamp(cx + (x % 2 ? 1 : -1), 0, last), ny = std::clamp(cy + (y % 2 ? 1 : -1), 0, last);
  const glm::vec4* near_row = &coarse.texels[static_cast<size_t>(cy) * coarse.size];
  const glm::vec4* far_row = &coarse.texels[static_cast<size_t>(ny) * coarse.size];
  return 0.5625f * near_row[cx] + 0.1875f * (near_row[nx] + far_row[cx]) + 0.0625f * far_row[nx];
}

void pull(const Level& coarse, std::vector<glm::vec4>& fine, int fine_size) {
  for (int y = 0; y < fine_size; ++y) {
    glm::vec4* row = &fine[static_cast<size_t>(y) * fine_size];
    for (int x = 0; x < fine_size; ++x) {
      if (row[x].w >= 1) continue;
      const glm::vec4 below = sample(coarse, x, y);
      if (below.w > 0) row[x] += (1 - row[x].w) / below.w * below;
    }
  }
}

}  // namespace

void pushPull(std::vector<glm::vec4>& field, int size) {
  std::vector<Level> levels;
  levels.reserve(16);
  const std::vector<glm::vec4>* fine = &field;
  for (int s = size; s > 1; s = (s + 1) / 2) {
    levels.emplace_back();
    push(*fine, s, levels.back());
    fine = &levels.back().texels;
  }
  for (size_t i = levels.size(); i-- > 0;) {
    std::vector<glm::vec4>& finer = i == 0 ? field : levels[i - 1].texels;
    pull(levels[i], finer, i == 0 ? size : levels[i - 1].size);
  }
}

}  // namespace fourdvt::bake

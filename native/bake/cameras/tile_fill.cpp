// SPDX-License-Identifier: Apache-2.0
#include "bake/cameras/tile_fill.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace fourdvt::bake {
namespace {

constexpr int kLevels = 5;  // the last one's texels are 32 texels wide
const glm::vec4 kFar(128, 128, 128, 1);

// xyz = colour × weight, w = weight: 0 unknown … 1 known.
struct Field {
  int width = 0, height = 0;
  std::vector<glm::vec4> texels;
  Field(int w, int h) : width(w), height(h), texels(size_t(w) * h, glm::vec4(0)) {}
  glm::vec4* row(int y) { return &texels[size_t(y) * width]; }
  const glm::vec4* row(int y) const { return &texels[size_t(y) * width]; }
};

glm::vec4 weighted(const uint8_t* rgba) {
  const float alpha = rgba[3] / 255.0f;
  return {alpha * rgba[0], alpha * rgba[1], alpha * rgba[2], alpha};
}

// The shares in which the pixels of one line lie under its texels.
struct Shares {
  struct Share {
    int pixel;
    float share;
  };
  std::vector<std::vector<Share>> of;  // [texel]
  Shares(int pixels, int texels) : of(size_t(texels)) {
    const double step = double(pixels) / texels;
    for (int t = 0; t < texels; ++t) {
      const double begin = t * step, end = std::min((t + 1) * step, double(pixels));
      for (int p = static_cast<int>(begin); p < pixels && p < end; ++p)
        of[size_t(t)].push_back({p, float((std::min(end, p + 1.0) - std::max(begin, double(p))) / step)});
    }
  }
};

void shrink(const Image& source, const glm::ivec2& tile, Field& out) {
  const Shares columns(source.width, tile.x), rows(source.height, tile.y);
  for (int y = 0; y < tile.y; ++y) {
    for (const Shares::Share& r : rows.of[size_t(y)]) {
      for (int x = 0; x < tile.x; ++x) {
        for (const Shares::Share& c : columns.of[size_t(x)])
          out.row(y)[x] += r.share * c.share * weighted(source.at(c.pixel, r.pixel));
      }
    }
  }
}

void copy(const Image& source, Field& out) {
  for (int y = 0; y < source.height; ++y) {
    for (int x = 0; x < source.width; ++x) out.row(y)[x] = weighted(source.at(x, y));
  }
}

// Every coarse texel: the sum of up to four fine ones; its weight saturates at 1.
Field coarser(const Field& fine) {
  Field out((fine.width + 1) / 2, (fine.height + 1) / 2);
  for (int y = 0; y < fine.height; ++y) {
    for (int x = 0; x < fine.width; ++x) out.row(y / 2)[x / 2] += fine.row(y)[x];
  }
  for (glm::vec4& t : out.texels) {
    if (t.w > 1) t /= t.w;
  }
  return out;
}

// Bilinear (1/4, 3/4) sample of the coarse level at fine texel (x, y).
glm::vec4 sample(const Field& coarse, int x, int y) {
  const int cx = x / 2, cy = y / 2;
  const int nx = std::clamp(cx + (x % 2 ? 1 : -1), 0, coarse.width - 1);
  const int ny = std::clamp(cy + (y % 2 ? 1 : -1), 0, coarse.height - 1);
  const glm::vec4 *near_row = coarse.row(cy), *far_row = coarse.row(ny);
  return 0.5625f * near_row[cx] + 0.1875f * (near_row[nx] + far_row[cx]) + 0.0625f * far_row[nx];
}

void fillFrom(const Field& coarse, Field& fine) {
  for (int y = 0; y < fine.height; ++y) {
    glm::vec4* row = fine.row(y);
    for (int x = 0; x < fine.width; ++x) {
      if (row[x].w >= 1) continue;
      const glm::vec4 below = sample(coarse, x, y);
      if (below.w > 0) row[x] += (1 - row[x].w) / below.w * below;
    }
  }
}

// Colours reach as far as a texel of the last level is wide; beyond them all is mid-grey, always, so that it costs
// nothing.
void pushPull(Field& field, int levels) {
  if (levels == 0) {
    for (glm::vec4& t : field.texels) t += (1 - t.w) * kFar;
    return;
  }
  Field coarse = coarser(field);
  pushPull(coarse, levels - 1);
  fillFrom(coarse, field);
}

}  // namespace

Image drawTile(const Image& source, const glm::ivec2& tile, const glm::ivec2& cells) {
  Field field(cells.x, cells.y);
  if (tile == glm::ivec2(source.width, source.height))
    copy(source, field);
  else
    shrink(source, tile, field);
  pushPull(field, kLevels);
  Image out(cells.x, cells.y, 3, 128);
  for (size_t i = 0; i < field.texels.size(); ++i) {
    const glm::vec4& t = field.texels[i];
    for (int c = 0; t.w > 0 && c < 3; ++c)
      out.pixels[3 * i + c] = static_cast<uint8_t>(std::clamp(t[c] / t.w + 0.5f, 0.0f, 255.0f));
  }
  return out;
}

}  // namespace fourdvt::bake

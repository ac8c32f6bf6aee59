// SPDX-License-Identifier: Apache-2.0
#include "encode/camera_layout.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <vector>

#include "base/text.h"
#include "encode/tile.h"

namespace fourdvt::encode {
namespace {

using package::CameraTile, package::Rect;

constexpr int kWidestTried = 4 * package::kMaxPictureSide;

int wholeCells(int texels) { return (texels + kCellTexels - 1) / kCellTexels * kCellTexels; }

// Widens one side of a source round the region to as many whole cells as the picture has room for.
void widenToCells(int picture_side, int& begin, int& length) {
  const int wanted = std::min(wholeCells(length), picture_side);
  begin = std::clamp(begin - (wanted - length) / 2, 0, picture_side - wanted);
  length = wanted;
}

// Tile without a place.
CameraTile tileOf(const PinholeCamera& camera, const Rect& region, double scale) {
  CameraTile out;
  if (region.width == 0) return out;
  out.source = region;
  if (scale == 1) {
    widenToCells(camera.width, out.source.x, out.source.width);
    widenToCells(camera.height, out.source.y, out.source.height);
  }
  out.tile.width = std::max(1, static_cast<int>(std::lround(out.source.width * scale)));
  out.tile.height = std::max(1, static_cast<int>(std::lround(out.source.height * scale)));
  return out;
}

bool accepted(const CameraLayout& l) {
  return l.picture_width <= package::kMaxPictureSide && l.picture_height <= package::kMaxPictureSide;
}

bool better(const CameraLayout& a, const CameraLayout& b) {
  if (accepted(a) != accepted(b)) return accepted(a);
  if (a.pictureTexels() != b.pictureTexels()) return a.pictureTexels() < b.pictureTexels();
  return std::max(a.picture_width, a.picture_height) < std::max(b.picture_width, b.picture_height);
}

using Sizes = std::vector<std::vector<glm::ivec2>>;  // [GOP][camera], whole cells

// Sizes of the layout at this width, without tiles.
CameraLayout sizesAt(const Sizes& sizes, int width) {
  CameraLayout out;
  for (const auto& gop : sizes) out.height = std::max(out.height, packInto(gop, width).height);
  out.width = width;
  out.picture_width = std::max(width, kBarcodeWidth);
  out.barcode.rect = {0, out.height, kBarcodeWidth, out.barcode.cell_size};
  out.picture_height = out.height + out.barcode.cell_size;
  return out;
}

}  // namespace

Rect regionOfInterest(const PinholeCamera& camera, const Positions& surface) {
  const PictureRegion region = regionOf(camera, surface);
  return {region.x, region.y, region.width, region.height};
}

Rect united(const Rect& a, const Rect& b) {
  if (a.width == 0) return b;
  if (b.width == 0) return a;
  const int x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  return {x, y, std::max(a.x + a.width, b.x + b.width) - x, std::max(a.y + a.height, b.y + b.height) - y};
}

Rect cellsOf(const Rect& tile) { return {tile.x, tile.y, wholeCells(tile.width), wholeCells(tile.height)}; }

CameraLayout planCameraLayout(const std::vector<PinholeCamera>& cameras, const std::vector<std::vector<Rect>>& regions,
                              double tile_scale) {
  std::vector<std::vector<CameraTile>> tiles;
  Sizes sizes;
  int widest = kCellTexels;
  for (const auto& gop : regions) {
    tiles.emplace_back();
    sizes.emplace_back();
    for (size_t c = 0; c < cameras.size(); ++c) {
      tiles.back().push_back(tileOf(cameras[c], gop[c], tile_scale));
      const Rect cells = cellsOf(tiles.back().back().tile);
      sizes.back().emplace_back(cells.width, cells.height);
      widest = std::max(widest, cells.width);
    }
  }
  CameraLayout best = sizesAt(sizes, widest);
  for (int width = widest + kCellTexels; width <= kWidestTried; width += kCellTexels) {
    const CameraLayout other = sizesAt(sizes, width);
    if (better(other, best)) best = other;
    if (width > package::kMaxPictureSide && accepted(best)) break;
  }
  best.height = std::max(best.height, 1);
  for (size_t g = 0; g < tiles.size(); ++g) {
    const Packing packing = packInto(sizes[g], best.width);
    for (size_t c = 0; c < cameras.size(); ++c) {
      if (tiles[g][c].empty()) continue;
      tiles[g][c].tile.x = packing.places[c].x;
      tiles[g][c].tile.y = packing.places[c].y;
    }
  }
  best.gops = std::move(tiles);
  return best;
}

Rect scaledCells(const Rect& cells, int eighths) {
  const auto scaled = [&](int texels) { return texels * eighths / 8; };
  return {scaled(cells.x), scaled(cells.y), scaled(cells.width), scaled(cells.height)};
}

CameraPicture scaledPicture(const CameraLayout& layout, int eighths) {
  CameraPicture out;
  out.tiles = scaledCells({0, 0, layout.width, layout.height}, eighths);
  out.tiles.height = std::max(out.tiles.height, 1);
  const int barcode_y = wholeCells(out.tiles.height);
  out.barcode.rect = {0, barcode_y, kBarcodeWidth, out.barcode.cell_size};
  out.width = std::max(wholeCells(out.tiles.width), kBarcodeWidth);
  out.height = barcode_y + out.barcode.cell_size;
  return out;
}

std::string checkCameraLayout(const CameraLayout& layout, double tile_scale, double max_texels) {
  const double allowed = std::min(max_texels, double(package::kMaxPictureSide) * package::kMaxPictureSide);
  if (accepted(layout) && layout.pictureTexels() <= allowed) return {};
  // Sides shrink with the scale, except for rounding up to cells: starts a little below the estimate.
  const double fits = std::sqrt(std::min(1.0, allowed / layout.pictureTexels()));
  const double scale = std::max(0.01, std::floor(tile_scale * std::min(fits * 0.97, 0.99) * 100) / 100);
  return printed(
      "the cameras' pictures of the performer need a tiled picture of %d x %d texels (%.2f million), more than "
      "%.2f million or %d a side; use --tile-scale %.2f%s",
      layout.picture_width, layout.picture_height, layout.pictureTexels() / 1e6, max_texels / 1e6,
      package::kMaxPictureSide, scale, accepted(layout) ? ", or a larger --tile-texels" : "");
}

namespace {

struct Step {  // skyline step: occupied above y, from x to the next step's x
  int x, y;
};

class Skyline {
 public:
  explicit Skyline(int width) : width_(width), steps_{{0, 0}} {}

  glm::ivec2 place(const glm::ivec2& size) {
    size_t best = 0;
    int best_y = heightFor(0, size.x);
    for (size_t s = 1; s < steps_.size() && steps_[s].x + size.x <= width_; ++s) {
      const int y = heightFor(s, size.x);
      if (y < best_y) best = s, best_y = y;
    }
    const int x = steps_[best].x;
    raise(best, x + size.x, best_y + size.y);
    return {x, best_y};
  }

 private:
  int endOf(size_t s) const { return s + 1 < steps_.size() ? steps_[s + 1].x : width_; }

  // Lowest free y for a rectangle that begins with this step.
  int heightFor(size_t s, int width) const {
    int y = 0;
    for (const int end = steps_[s].x + width; s < steps_.size() && steps_[s].x < end; ++s) y = std::max(y, steps_[s].y);
    return y;
  }

  // Sets the skyline to y from the beginning of a step to x = end.
  void raise(size_t first, int end, int y) {
    size_t last = first;
    while (last + 1 < steps_.size() && steps_[last + 1].x < end) ++last;
    const Step rest{end, steps_[last].y};
    const bool has_rest = endOf(last) > end;
    steps_[first].y = y;
    steps_.erase(steps_.begin() + long(first) + 1, steps_.begin() + long(last) + 1);
    if (has_rest) steps_.insert(steps_.begin() + long(first) + 1, rest);
  }

  const int width_;
  std::vector<Step> steps_;
};

}  // namespace

Packing packInto(std::span<const glm::ivec2> sizes, int width) {
  std::vector<size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return sizes[a].y != sizes[b].y ? sizes[a].y > sizes[b].y : sizes[a].x > sizes[b].x;
  });
  Packing out{0, std::vector<glm::ivec2>(sizes.size(), glm::ivec2(0))};
  Skyline skyline(width);
  for (const size_t i : order) {
    if (sizes[i].x <= 0 || sizes[i].y <= 0) continue;
    out.places[i] = skyline.place(sizes[i]);
    out.height = std::max(out.height, out.places[i].y + sizes[i].y);
  }
  return out;
}

namespace {

constexpr int kLevels = 5;  // texels of the last level are 32 texels wide
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

// Coverage of the pixels of one line by its texels.
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

// Colours extend by the width of a texel of the last level; beyond, all is constant mid-grey, which costs no bits.
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

}  // namespace fourdvt::encode

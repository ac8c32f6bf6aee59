// SPDX-License-Identifier: Apache-2.0
#include "bake/cameras/camera_layout.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bake/cameras/packing.h"

namespace fourdvt::bake {
namespace {

using package::CameraTile, package::Rect;

constexpr int kBarcodeWidth = 2 * 16 * package::BarcodeStrip().cell_size;
constexpr int kWidestTried = 4 * package::kMaxPictureSide;

int wholeCells(int texels) { return (texels + kCellTexels - 1) / kCellTexels * kCellTexels; }

// One side of a source: as many whole cells as the picture has room for, round the region.
void widenToCells(int picture_side, int& begin, int& length) {
  const int wanted = std::min(wholeCells(length), picture_side);
  begin = std::clamp(begin - (wanted - length) / 2, 0, picture_side - wanted);
  length = wanted;
}

// Not placed yet.
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

// The layout's sizes at this width, without tiles.
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
  // Sides shrink with the scale, but not those that are rounded up to cells: a little less than it takes.
  const double fits = std::sqrt(std::min(1.0, allowed / layout.pictureTexels()));
  const double scale = std::max(0.01, std::floor(tile_scale * std::min(fits * 0.97, 0.99) * 100) / 100);
  char text[240];
  std::snprintf(
      text, sizeof text,
      "the cameras' pictures of the performer need a tiled picture of %d x %d texels (%.2f million), more than "
      "%.2f million or %d a side; use --tile-scale %.2f%s",
      layout.picture_width, layout.picture_height, layout.pictureTexels() / 1e6, max_texels / 1e6,
      package::kMaxPictureSide, scale, accepted(layout) ? ", or a larger --tile-texels" : "");
  return text;
}

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
#include "live/server/tiles.h"

#include <algorithm>
#include <cmath>

#include "encode/camera_layout.h"

namespace fourdvt::live {
namespace {

using package::CameraTile, package::Rect;

constexpr double kSourceShare = 0.08;  // margin of a source, relative to the performer's longer side
constexpr int kSourcePixels = 6;
constexpr int kLeaves_px = 2;        // maximum excess over the source before a new layout is requested
constexpr double kSmaller = 0.96;    // ratio of successive scales
constexpr double kAspect = 4.0 / 3;  // width over height of the layout
constexpr int kCells = 2 * 16;       // cells of the barcode, in a row
constexpr int kLargeCell = 16, kSmallCell = 8;

int wholeCells(double texels) {
  return std::max(1, int(std::ceil(texels / encode::kCellTexels - 1e-9))) * encode::kCellTexels;
}

int right(const Rect& r) { return r.x + r.width; }
int bottom(const Rect& r) { return r.y + r.height; }

Rect between(int x0, int y0, int x1, int y1) {
  if (x0 >= x1 || y0 >= y1) return {};
  return {x0, y0, x1 - x0, y1 - y0};
}

}  // namespace

Result<PackedSize> packedSize(std::span<const PinholeCamera> cameras, double share) {
  double pixels = 0;
  for (const PinholeCamera& camera : cameras) pixels += double(camera.width) * camera.height;
  PackedSize out;
  out.width = std::max(wholeCells(std::sqrt(share * pixels * kAspect)), kCells * kSmallCell);
  const int height = wholeCells(share * pixels / out.width);
  out.height = height + encode::kCellTexels;
  out.tiles = {0, 0, out.width, height};
  out.barcode.cell_size = out.width >= kCells * kLargeCell ? kLargeCell : kSmallCell;
  out.barcode.rect = {0, height, kCells * out.barcode.cell_size, encode::kCellTexels};
  if (std::max(out.width, out.height) <= package::kMaxPictureSide) return out;
  return Error{ErrorId::InvalidArgument, "the packed picture would have " + std::to_string(out.width) + " x " +
                                             std::to_string(out.height) + " texels, more than " +
                                             std::to_string(package::kMaxPictureSide) +
                                             " a side; lower the share of the picture"};
}

Rect projectedBox(const PinholeCamera& camera, const Positions& positions) {
  glm::dvec2 low(1e9), high(-1e9);
  for (const glm::vec3& position : positions) {
    const glm::dvec3 p = camera.project(glm::dvec3(position));
    if (p.z <= 0) continue;
    low = glm::min(low, glm::dvec2(p));
    high = glm::max(high, glm::dvec2(p));
  }
  low = glm::clamp(low, 0.0, 1e5), high = glm::clamp(high, -1.0, 1e5);
  return between(int(std::floor(low.x)), int(std::floor(low.y)), std::min(int(std::ceil(high.x)), camera.width),
                 std::min(int(std::ceil(high.y)), camera.height));
}

Rect padded(const Rect& box, double share, int pixels, const Rect& limits) {
  if (box.width == 0) return {};
  const int margin = pixels + int(std::ceil(share * std::max(box.width, box.height)));
  const auto even = [](int v) { return v & ~1; };
  return common(between(even(box.x - margin), even(box.y - margin), even(right(box) + margin + 1),
                        even(bottom(box) + margin + 1)),
                limits);
}

Rect common(const Rect& a, const Rect& b) {
  return between(std::max(a.x, b.x), std::max(a.y, b.y), std::min(right(a), right(b)), std::min(bottom(a), bottom(b)));
}

bool LiveTiles::wantsLayout(std::span<const Rect> boxes, std::span<const Rect> crops) const {
  if (tiles_.empty()) return true;
  for (size_t c = 0; c < cameras_.size(); ++c) {
    const Rect shown = common(boxes[c], crops[c]);
    if (shown.width == 0) continue;
    const Rect& source = tiles_[c].source;
    if (source.width == 0) return true;
    const int beyond = std::max(
        {source.x - shown.x, source.y - shown.y, right(shown) - right(source), bottom(shown) - bottom(source)});
    if (beyond > kLeaves_px) return true;
  }
  return false;
}

bool LiveTiles::place(std::vector<CameraTile>& tiles) const {
  std::vector<glm::ivec2> sizes;
  for (const CameraTile& t : tiles) {
    const Rect cells = t.empty() ? Rect{} : encode::cellsOf(t.tile);
    if (cells.width > size_.tiles.width) return false;
    sizes.emplace_back(cells.width, cells.height);
  }
  const encode::Packing packing = encode::packInto(sizes, size_.tiles.width);
  if (packing.height > size_.tiles.height) return false;
  for (size_t c = 0; c < tiles.size(); ++c)
    if (!tiles[c].empty()) tiles[c].tile.x = packing.places[c].x, tiles[c].tile.y = packing.places[c].y;
  return true;
}

void LiveTiles::plan(std::span<const Rect> boxes, std::span<const Rect> crops) {
  std::vector<CameraTile> wanted(cameras_.size());
  for (size_t c = 0; c < cameras_.size(); ++c)
    wanted[c].source = padded(boxes[c], kSourceShare, kSourcePixels, crops[c]);
  for (double scale = 1; scale > 0.01; scale *= kSmaller) {
    for (CameraTile& t : wanted) {
      const auto scaled = [&](int pixels) { return std::max(2, int(std::lround(pixels * scale / 2)) * 2); };
      if (!t.empty()) t.tile = {0, 0, scaled(t.source.width), scaled(t.source.height)};
    }
    if (!place(wanted)) continue;
    tiles_ = std::move(wanted);
    scale_ = scale;
    return;
  }
  tiles_.assign(cameras_.size(), {});  // more cameras than cells
}

}  // namespace fourdvt::live

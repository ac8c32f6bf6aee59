// SPDX-License-Identifier: Apache-2.0
#include "encode/tile.h"

#include <algorithm>
#include <vector>

namespace fourdvt::encode {
namespace {

// The BT.709 matrix for 8 bits and limited range, times 2^20. Its rows sum to 219, 0 and 0 (times 2^20 / 255).
constexpr int kShift = 20;
constexpr double kOne = double(1 << kShift);
constexpr double kRed = 0.2126, kGreen = 0.7152, kBlue = 0.0722;
constexpr int round(double v) { return static_cast<int>(v < 0 ? v - 0.5 : v + 0.5); }
constexpr int kYr = round(kOne * 219 / 255 * kRed), kYg = round(kOne * 219 / 255 * kGreen),
              kYb = round(kOne * 219 / 255 * kBlue);
constexpr double kU = 224.0 / 255 / (2 * (1 - kBlue)), kV = 224.0 / 255 / (2 * (1 - kRed));
// These rows are applied to sums of four texels, hence the division by 4.
constexpr int kURow[3] = {round(-kOne / 4 * kU * kRed), round(-kOne / 4 * kU * kGreen),
                          round(kOne / 4 * kU * (1 - kBlue))};
constexpr int kVRow[3] = {round(kOne / 4 * kV * (1 - kRed)), round(-kOne / 4 * kV * kGreen),
                          round(-kOne / 4 * kV * kBlue)};

uint8_t luma(const uint8_t* p) {
  return static_cast<uint8_t>((kYr * p[0] + kYg * p[1] + kYb * p[2] + (16 << kShift) + (1 << (kShift - 1))) >> kShift);
}

// `sum`: of four texels. `row`: the matrix row of U or V.
uint8_t chroma(const int (&sum)[3], const int (&row)[3]) {
  return static_cast<uint8_t>(
      (row[0] * sum[0] + row[1] * sum[1] + row[2] * sum[2] + (128 << kShift) + (1 << (kShift - 1))) >> kShift);
}

bool fits(const TileLayout& layout) {
  return layout.width <= package::kMaxPictureSide && layout.height <= package::kMaxPictureSide;
}

TileLayout gridLayout(int layer_count, int texture, int columns) {
  TileLayout layout;
  const int rows = (layer_count + columns - 1) / columns;
  for (int l = 0; l < layer_count; ++l)
    layout.layers.push_back({(l % columns) * texture, (l / columns) * texture, texture, texture});
  const int last_x = (layer_count - (rows - 1) * columns) * texture;  // end of the last row
  const bool free_cell = columns * texture - last_x >= kBarcodeWidth;
  const int barcode_y = free_cell ? (rows - 1) * texture : rows * texture;
  layout.barcode.rect = {free_cell ? last_x : 0, barcode_y, kBarcodeWidth, layout.barcode.cell_size};
  layout.width = std::max(columns * texture, kBarcodeWidth);
  layout.height = std::max(rows * texture, barcode_y + layout.barcode.cell_size);
  return layout;
}

// True if `a` is better: prefers layouts that fit, then the one with the fewest texels; if neither fits, the smaller
// one.
bool better(const TileLayout& a, const TileLayout& b) {
  if (fits(a) != fits(b)) return fits(a);
  if (!fits(a)) return std::max(a.width, a.height) < std::max(b.width, b.height);
  return a.width * a.height < b.width * b.height;
}

TileLayout equalLayout(int layer_count, int texture) {
  TileLayout best = gridLayout(layer_count, texture, 1);
  for (int columns = 2; columns <= layer_count; ++columns) {
    const TileLayout other = gridLayout(layer_count, texture, columns);
    if (better(other, best)) best = other;
  }
  return best;
}

// Lays out every member as a block: layer 1 at the left, further layers of half its side in columns of two to its
// right.
TileLayout stackedLayout(int layer_count, int texture, int member_count, int columns) {
  TileLayout layout;
  const int half = texture / 2, rows = (member_count + columns - 1) / columns;
  const int block_width = texture + layer_count / 2 * half;
  for (int m = 0; m < member_count; ++m) {
    const int x = m / rows * block_width, y = m % rows * texture;
    layout.layers.push_back({x, y, texture, texture});
    for (int k = 0; k + 1 < layer_count; ++k)
      layout.layers.push_back({x + texture + (k / 2) * half, y + (k % 2) * half, half, half});
  }
  layout.barcode.rect = {0, rows * texture, kBarcodeWidth, layout.barcode.cell_size};
  layout.width = std::max(columns * block_width, kBarcodeWidth);
  layout.height = rows * texture + layout.barcode.cell_size;
  return layout;
}

uint8_t clampByte(double v) { return static_cast<uint8_t>(std::clamp(v + 0.5, 0.0, 255.0)); }

}  // namespace

TileLayout makeTileLayout(int layer_count, int texture, bool equal_layers, int member_count) {
  if (equal_layers) return equalLayout(layer_count * member_count, texture);
  TileLayout layout = stackedLayout(layer_count, texture, member_count, 1);
  for (int columns = 2; columns <= member_count && !fits(layout); ++columns) {
    const TileLayout other = stackedLayout(layer_count, texture, member_count, columns);
    if (better(other, layout)) layout = other;
  }
  return layout;
}

std::string checkTileLayout(int layer_count, int texture, bool equal_layers, int member_count) {
  const TileLayout layout = makeTileLayout(layer_count, texture, equal_layers, member_count);
  if (fits(layout)) return {};
  return (member_count > 1 ? std::to_string(member_count) + " members of " : std::string()) + "layers " +
         std::to_string(layer_count) + " with texture " + std::to_string(texture) +
         (equal_layers ? " and equal layers" : "") + " need a picture of " + std::to_string(layout.width) + " x " +
         std::to_string(layout.height) + ", more than " + std::to_string(package::kMaxPictureSide) +
         "; use fewer layers" + (equal_layers ? ", smaller further layers" : "") + " or a smaller texture";
}

I420Picture::I420Picture(int w, int h)
    : width(w),
      height(h),
      y(static_cast<size_t>(w) * h, 126),
      u(static_cast<size_t>(w / 2) * (h / 2), 128),
      v(static_cast<size_t>(w / 2) * (h / 2), 128) {}

I420View I420Picture::view() const {
  return {width, height, y.data(), u.data(), v.data(), width, width / 2, width / 2};
}

void drawLayer(const Image& layer, const package::Rect& rect, I420Picture& picture) {
  for (int y = 0; y < rect.height; ++y) {
    uint8_t* out = &picture.y[static_cast<size_t>(rect.y + y) * picture.width + rect.x];
    for (int x = 0; x < rect.width; ++x) out[x] = luma(layer.at(x, y));
  }
  for (int y = 0; y < rect.height / 2; ++y) {
    const size_t row = static_cast<size_t>(rect.y / 2 + y) * (picture.width / 2) + rect.x / 2;
    for (int x = 0; x < rect.width / 2; ++x) {
      const uint8_t *a = layer.at(2 * x, 2 * y), *b = layer.at(2 * x + 1, 2 * y), *c = layer.at(2 * x, 2 * y + 1),
                    *d = layer.at(2 * x + 1, 2 * y + 1);
      const int sum[3] = {a[0] + b[0] + c[0] + d[0], a[1] + b[1] + c[1] + d[1], a[2] + b[2] + c[2] + d[2]};
      picture.u[row + x] = chroma(sum, kURow);
      picture.v[row + x] = chroma(sum, kVRow);
    }
  }
}

void tileFrame(const TileLayout& layout, const std::vector<const Image*>& layers, uint32_t frame,
               I420Picture& picture) {
  for (size_t l = 0; l < layers.size(); ++l) drawLayer(*layers[l], layout.layers[l], picture);
  package::drawBarcode(layout.barcode, frame, picture.y.data(), picture.width);
}

void tileFrame(const TileLayout& layout, const std::vector<Image>& layers, uint32_t frame, I420Picture& picture) {
  std::vector<const Image*> pointers;
  for (const Image& layer : layers) pointers.push_back(&layer);
  tileFrame(layout, pointers, frame, picture);
}

void tileShrunk(const std::vector<package::Rect>& rects, const std::vector<const Image*>& images,
                const package::BarcodeStrip& barcode, uint32_t frame, I420Picture& picture) {
  for (size_t i = 0; i < images.size(); ++i)
    drawLayer(shrunk(*images[i], rects[i].width, rects[i].height), rects[i], picture);
  package::drawBarcode(barcode, frame, picture.y.data(), picture.width);
}

Image rgbFromTile(const I420View& p, const package::Rect& rect) {
  Image out(rect.width, rect.height, 3);
  for (int y = 0; y < rect.height; ++y) {
    for (int x = 0; x < rect.width; ++x) {
      const int px = rect.x + x, py = rect.y + y;
      const double luma = (p.y[py * p.stride_y + px] - 16) * 255.0 / 219;
      const double u = (p.u[py / 2 * p.stride_u + px / 2] - 128) * 255.0 / 224 * 2 * (1 - kBlue);
      const double v = (p.v[py / 2 * p.stride_v + px / 2] - 128) * 255.0 / 224 * 2 * (1 - kRed);
      uint8_t* o = out.at(x, y);
      o[0] = clampByte(luma + v);
      o[1] = clampByte(luma - (kRed * v + kBlue * u) / kGreen);
      o[2] = clampByte(luma + u);
    }
  }
  return out;
}

namespace {

// Part of a source texel under a texel of the result, in units of 1 / target of a source texel: whole numbers, which
// add up to `source` for every texel of the result.
struct Share {
  int texel = 0;
  uint32_t units = 0;
};

std::vector<std::vector<Share>> sharesOf(int source, int target) {
  std::vector<std::vector<Share>> out(static_cast<size_t>(target));
  for (int t = 0; t < target; ++t) {
    const int64_t begin = int64_t(t) * source, end = begin + source;
    for (int64_t s = begin / target; s * target < end; ++s) {
      const int64_t units = std::min(end, (s + 1) * target) - std::max(begin, s * target);
      out[static_cast<size_t>(t)].push_back({static_cast<int>(s), static_cast<uint32_t>(units)});
    }
  }
  return out;
}

// Weighted sums of one row: 3 per texel of the result.
void sumRow(const Image& source, int y, const std::vector<std::vector<Share>>& columns, std::vector<uint32_t>& out) {
  auto sum = out.begin();
  for (const std::vector<Share>& shares : columns) {
    uint32_t rgb[3] = {0, 0, 0};
    for (const Share& share : shares) {
      const uint8_t* p = source.at(share.texel, y);
      for (int c = 0; c < 3; ++c) rgb[c] += share.units * p[c];
    }
    sum = std::copy(rgb, rgb + 3, sum);
  }
}

}  // namespace

Image shrunk(const Image& source, int width, int height) {
  const auto columns = sharesOf(source.width, width), rows = sharesOf(source.height, height);
  const uint64_t whole = uint64_t(source.width) * uint64_t(source.height);
  Image out(width, height, 3);
  std::vector<uint32_t> row(size_t(3) * size_t(width));
  std::vector<uint64_t> sums(row.size());
  int summed = -1;  // source row in `row`; neighbouring rows of the result may share one
  for (int y = 0; y < height; ++y) {
    std::fill(sums.begin(), sums.end(), whole / 2);
    for (const Share& share : rows[static_cast<size_t>(y)]) {
      if (summed != share.texel) sumRow(source, summed = share.texel, columns, row);
      for (size_t i = 0; i < row.size(); ++i) sums[i] += uint64_t(share.units) * row[i];
    }
    for (size_t i = 0; i < sums.size(); ++i) out.at(0, y)[i] = static_cast<uint8_t>(sums[i] / whole);
  }
  return out;
}

}  // namespace fourdvt::encode

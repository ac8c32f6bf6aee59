// SPDX-License-Identifier: Apache-2.0
#include "bake/texels/picture_crop.h"

#include <algorithm>

#include "encode/camera_layout.h"
#include "encode/tile.h"

namespace fourdvt::bake {
namespace {

constexpr int kEdgePixels = 2;    // width of the border that the backdrop's colour contaminates
constexpr int kReach[] = {3, 7};  // search radii in pixels for inside colour; corners need the second

// 1 where every pixel within kEdgePixels (in x and y) is opaque; pixels beyond the picture's edge do not count.
std::vector<uint8_t> insideMask(const Image& image) {
  const int w = image.width, h = image.height;
  std::vector<uint8_t> rows(size_t(w) * h), inside(size_t(w) * h);
  for (int y = 0; y < h; ++y) {
    int opaque_run = w;  // opaque pixels up to and including the current one
    for (int x = 0; x < w + kEdgePixels; ++x) {
      if (x < w)
        opaque_run = image.at(x, y)[3] >= kOpaque ? opaque_run + 1 : 0;
      else
        ++opaque_run;
      const int centre = x - kEdgePixels;
      if (centre >= 0) rows[size_t(y) * w + centre] = opaque_run > 2 * kEdgePixels;
    }
  }
  for (int y = 0; y < h; ++y) {
    const int first = std::max(0, y - kEdgePixels), last = std::min(h - 1, y + kEdgePixels);
    for (int x = 0; x < w; ++x) {
      uint8_t all = 1;
      for (int k = first; k <= last; ++k) all &= rows[size_t(k) * w + x];
      inside[size_t(y) * w + x] = all;
    }
  }
  return inside;
}

// Mean colour of the inside pixels within `reach` of `at`, weighted towards near ones. False if there are none.
bool insideColour(const Image& image, const std::vector<uint8_t>& inside, const glm::ivec2& at, int reach,
                  uint8_t* out) {
  const int x = at.x, y = at.y;
  float sum[3] = {0, 0, 0}, total = 0;
  for (int v = std::max(0, y - reach); v <= std::min(image.height - 1, y + reach); ++v) {
    for (int u = std::max(0, x - reach); u <= std::min(image.width - 1, x + reach); ++u) {
      if (!inside[size_t(v) * image.width + u]) continue;
      const int squared = (u - x) * (u - x) + (v - y) * (v - y);
      const float weight = 1.0f / float(squared * squared);
      for (int c = 0; c < 3; ++c) sum[c] += weight * image.at(u, v)[c];
      total += weight;
    }
  }
  if (total == 0) return false;
  for (int c = 0; c < 3; ++c) out[c] = static_cast<uint8_t>(sum[c] / total + 0.5f);
  return true;
}

}  // namespace

void replaceEdgeColours(Image& rgba) {
  const std::vector<uint8_t> inside = insideMask(rgba);
  for (int y = 0; y < rgba.height; ++y) {
    for (int x = 0; x < rgba.width; ++x) {
      uint8_t* p = rgba.at(x, y);
      if (p[3] == 0 || inside[size_t(y) * rgba.width + x]) continue;
      for (int reach : kReach)
        if (insideColour(rgba, inside, {x, y}, reach, p)) break;  // safe in place, because it reads inside pixels only
    }
  }
}

PictureCrop cropPicture(const PinholeCamera& camera, const Positions& positions, const Image& picture) {
  PictureCrop crop;
  crop.region = regionOf(camera, positions);
  const PictureRegion& region = crop.region;
  if (region.empty()) return crop;
  Image part(region.width, region.height, 4);
  for (int y = 0; y < region.height; ++y)
    std::copy_n(picture.at(region.x, region.y + y), size_t(region.width) * 4, part.at(0, y));
  replaceEdgeColours(part);
  crop.premultiplied = std::move(part.pixels);
  for (size_t i = 0; i < crop.premultiplied.size(); i += 4) {
    uint8_t* p = &crop.premultiplied[i];
    for (int c = 0; c < 3; ++c) p[c] = static_cast<uint8_t>((p[c] * p[3] + 127) / 255);
  }
  return crop;
}

Image drawCameraTile(const package::CameraTile& tile, const Image& picture, const ColourMap* map) {
  const package::Rect& source = tile.source;
  Image crop(source.width, source.height, 4);
  for (int y = 0; y < source.height; ++y)
    std::copy_n(picture.at(source.x, source.y + y), size_t(source.width) * 4, crop.at(0, y));
  replaceEdgeColours(crop);
  if (map) applyColours(*map, crop);
  const package::Rect cells = encode::cellsOf(tile.tile);
  return encode::drawTile(crop, {tile.tile.width, tile.tile.height}, {cells.width, cells.height});
}

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Draws all layers and the barcode into one 4:2:0 picture for a single decoder; and smaller copies of layers and
// tiles, for renditions with fewer texels.
#pragma once

#include <string>
#include <vector>

#include "base/image.h"
#include "package/barcode.h"

namespace fourdvt::encode {

constexpr int kBarcodeWidth = 2 * package::kBarcodeCells * package::BarcodeStrip().cell_size;

struct TileLayout {
  int width = 0, height = 0;          // multiples of 16
  std::vector<package::Rect> layers;  // [member][layer]
  package::BarcodeStrip barcode;
};

// Default: layer 1 (texture²) at the left, further layers (half the side) in columns of two to its right, the barcode
// below. equal_layers: every layer is texture², in the grid with the fewest texels that keeps both sides within
// kMaxPictureSide if there is one; the barcode in a free cell, else below.
// Several members: their layouts stacked in as few columns as fit; with equal_layers, all layers in one grid.
TileLayout makeTileLayout(int layer_count, int texture, bool equal_layers = false, int member_count = 1);

// Reason why readers would reject a picture of this layout, with the remedy; empty if they accept it.
std::string checkTileLayout(int layer_count, int texture, bool equal_layers, int member_count = 1);

struct I420Picture {
  int width = 0, height = 0;
  std::vector<uint8_t> y, u, v;
  I420Picture() = default;
  I420Picture(int w, int h);  // all texels mid-grey
  I420View view() const;
};

// Draws one RGB(A) square into its rectangle, whose corners are even, in BT.709 limited range; chroma is the mean of
// 2 × 2 texels.
void drawLayer(const Image& layer, const package::Rect& rect, I420Picture& picture);

// layers: [member][layer]. `frame` goes into the barcode. `picture` has the layout's size.
void tileFrame(const TileLayout& layout, const std::vector<const Image*>& layers, uint32_t frame, I420Picture& picture);
void tileFrame(const TileLayout& layout, const std::vector<Image>& layers, uint32_t frame, I420Picture& picture);

// Draws every image, each scaled down to its rectangle alone, and the barcode; rectangles as in drawLayer.
void tileShrunk(const std::vector<package::Rect>& rects, const std::vector<const Image*>& images,
                const package::BarcodeStrip& barcode, uint32_t frame, I420Picture& picture);

// Reads one rectangle back as RGB, with chroma replicated, e.g. for stills.
Image rgbFromTile(const I420View& picture, const package::Rect& rect);

// Box-filters in encoded RGB: every texel is the mean of the area that it covers. width, height: at most those of
// `source`. Reads `source` alone, so that its neighbours in a tiled picture do not bleed in. RGB.
Image shrunk(const Image& source, int width, int height);

}  // namespace fourdvt::encode

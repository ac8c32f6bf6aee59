// SPDX-License-Identifier: Apache-2.0
// All layers and the barcode in one 4:2:0 picture, so that one decoder serves them.
#pragma once

#include <string>
#include <vector>

#include "base/image.h"
#include "package/character.h"

namespace fourdvt::bake {

struct TileLayout {
  int width = 0, height = 0;          // multiples of 16
  std::vector<package::Rect> layers;  // [member][layer]
  package::BarcodeStrip barcode;
};

// Default: layer 1 (texture²) at the left, further layers (half the side) in columns of two to its right, the barcode
// below. equal_layers: all of texture², in the grid with the fewest texels that keeps both sides within
// kMaxPictureSide if there is one; the barcode in a free cell, else below.
// Several members: the layers of each as above, stacked in as few columns as fit; equal layers all in one grid.
TileLayout makeTileLayout(int layer_count, int texture, bool equal_layers = false, int member_count = 1);

// Empty, or why the layout is no picture that readers accept, with the remedy.
std::string checkTileLayout(int layer_count, int texture, bool equal_layers, int member_count = 1);

struct I420Picture {
  int width = 0, height = 0;
  std::vector<uint8_t> y, u, v;
  I420Picture() = default;
  I420Picture(int w, int h);  // mid-grey
  I420View view() const;
};

// One RGB(A) square → its rectangle; BT.709 limited range, chroma = mean of 2 × 2 texels. Rectangle corners are even.
void drawLayer(const Image& layer, const package::Rect& rect, I420Picture& picture);

// layers: [member][layer]. `frame` goes into the barcode. `picture` has the layout's size.
void tileFrame(const TileLayout& layout, const std::vector<const Image*>& layers, uint32_t frame, I420Picture& picture);
void tileFrame(const TileLayout& layout, const std::vector<Image>& layers, uint32_t frame, I420Picture& picture);

// The inverse colour matrix for one rectangle (chroma replicated), e.g. for stills.
Image rgbFromTile(const I420View& picture, const package::Rect& rect);

}  // namespace fourdvt::bake

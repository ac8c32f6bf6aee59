// SPDX-License-Identifier: Apache-2.0
// Lays out the part of every camera's picture that a sequence keeps: tiles per GOP, in a layout of one size for the
// whole sequence, the barcode below. A surface is textured inside its own outline only, so that each camera's part is
// the surface's bounding box in its picture; mattes that reach further are not needed. Then draws the tiles.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"
#include "package/surface_chunk.h"

namespace fourdvt::encode {

constexpr int kCellTexels = 16;  // tiles begin at its multiples, so that no block of a codec shows two cameras

// Pixels of the camera's picture round a surface, with regionOf's margin; no width if the camera does not see it.
package::Rect regionOfInterest(const PinholeCamera& camera, const Positions& surface);
// Bounding rectangle of both; one without width is empty.
package::Rect united(const package::Rect& a, const package::Rect& b);

struct CameraLayout {
  int width = 0, height = 0;                           // texels of the layout
  std::vector<std::vector<package::CameraTile>> gops;  // [GOP][camera]
  int picture_width = 0, picture_height = 0;           // with the barcode below; the layout lies at (0, 0)
  package::BarcodeStrip barcode;

  double pictureTexels() const { return double(picture_width) * picture_height; }
};

// Texels drawn for a tile: its sides rounded up to whole cells.
package::Rect cellsOf(const package::Rect& tile);

// regions: [GOP][camera]. tile_scale: texels per pixel of the cameras' pictures, at most 1; at 1 sources are rounded
// up to whole cells. Selects the width with the fewest texels that readers accept, if there is one.
CameraLayout planCameraLayout(const std::vector<PinholeCamera>& cameras,
                              const std::vector<std::vector<package::Rect>>& regions, double tile_scale);

// A rendition's picture of the layout, `eighths` / 8 of its sides: cells become 2 · eighths texels, so that no texel
// and no chroma sample shows two cameras.
struct CameraPicture {
  int width = 0, height = 0;  // with the barcode below
  package::Rect tiles;        // position of the layout
  package::BarcodeStrip barcode;
};
CameraPicture scaledPicture(const CameraLayout& layout, int eighths);
package::Rect scaledCells(const package::Rect& cells, int eighths);

// Reason why readers, or the user's limit `max_texels`, rule out a picture of this layout, with the remedy; empty if
// none.
std::string checkCameraLayout(const CameraLayout& layout, double tile_scale, double max_texels);

struct Packing {
  int height = 0;
  std::vector<glm::ivec2> places;  // top left corners of the rectangles, in the order of the sizes
};

// Packs rectangles into a strip of this width by a skyline: in order of descending height, each goes to the highest
// free place. No rectangle is wider than the strip; those without area lie at (0, 0) and take no space. The same
// input gives the same places on every machine.
Packing packInto(std::span<const glm::ivec2> sizes, int width);

// Draws a tile: the performer in the camera's picture, surrounded by a smooth continuation of his colours, so that
// texture filters and surfaces may reach over his outline, and then mid-grey, which costs a codec no bits. source:
// RGBA with straight alpha (the matte), colours of the performer alone wherever alpha is above 0. It is drawn into
// `tile` texels at the top left of a picture of `cells` texels, each the mean of the pixels that it covers; areas
// without alpha or beyond the tile are filled. RGB.
Image drawTile(const Image& source, const glm::ivec2& tile, const glm::ivec2& cells);

}  // namespace fourdvt::encode

// SPDX-License-Identifier: Apache-2.0
// Which part of every camera's picture a sequence keeps, and where it lies in the tiled picture: tiles per GOP, in a
// layout of one size for the whole sequence, the barcode below. A surface is textured inside its own outline only, so
// that the part a camera keeps is the surface's bounding box in its picture; mattes that reach further are not needed.
#pragma once

#include <string>
#include <vector>

#include "base/camera.h"
#include "base/mesh.h"
#include "package/surface_chunk.h"

namespace fourdvt::bake {

constexpr int kCellTexels = 16;  // tiles begin at its multiples, so that no block of a codec shows two cameras

// Pixels of the camera's picture round a surface, with regionOf's margin; no width if the camera does not see it.
package::Rect regionOfInterest(const PinholeCamera& camera, const Positions& surface);
// The smallest rectangle that holds both; one without width holds nothing.
package::Rect united(const package::Rect& a, const package::Rect& b);

struct CameraLayout {
  int width = 0, height = 0;                           // texels of the layout
  std::vector<std::vector<package::CameraTile>> gops;  // [GOP][camera]
  int picture_width = 0, picture_height = 0;           // with the barcode below; the layout lies at (0, 0)
  package::BarcodeStrip barcode;

  double pictureTexels() const { return double(picture_width) * picture_height; }
};

// The texels that are drawn for a tile: the tile, with its sides rounded up to whole cells.
package::Rect cellsOf(const package::Rect& tile);

// regions: [GOP][camera]. tile_scale: texels per pixel of the cameras' pictures, at most 1; at 1 sources are rounded up
// to whole cells. Of all widths it takes the one with the fewest texels that readers accept, if there is one.
CameraLayout planCameraLayout(const std::vector<PinholeCamera>& cameras,
                              const std::vector<std::vector<package::Rect>>& regions, double tile_scale);

// A rendition's picture of the layout, `eighths` / 8 of its sides: cells become 2 · eighths texels, so that no texel
// and no chroma sample shows two cameras.
struct CameraPicture {
  int width = 0, height = 0;  // with the barcode below
  package::Rect tiles;        // where the layout lies
  package::BarcodeStrip barcode;
};
CameraPicture scaledPicture(const CameraLayout& layout, int eighths);
package::Rect scaledCells(const package::Rect& cells, int eighths);

// Why such a picture cannot be, with the remedy; empty if it can. max_texels: what the user allows.
std::string checkCameraLayout(const CameraLayout& layout, double tile_scale, double max_texels);

}  // namespace fourdvt::bake

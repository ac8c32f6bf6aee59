// SPDX-License-Identifier: Apache-2.0
// Pictures for inspection: grids with titles, camera maps in UV space, crops. All RGB, row 0 at the top.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"

namespace fourdvt::report {

// Grid of RGB pictures; an empty picture leaves its cell empty. Columns are as wide as their widest picture, rows as
// high as their highest. Titles: ASCII.
struct Sheet {
  std::string title;
  std::vector<std::string> columns, rows;  // rows may be empty: no row titles
  std::vector<std::vector<Image>> cells;   // [row][column]
};
Image drawSheet(const Sheet& sheet);

// Colour of a camera in `--debug labels` (shaders/gles/layered_shade.glsl); dark grey for an empty slot.
std::array<uint8_t, 3> labelColour(uint8_t camera);
// Faces in texture space, coloured by camera. labels: one per face. `side` pixels square.
Image cameraMap(const MeshTopology& topology, std::span<const uint8_t> labels, int side);
// Faces with differing labels, bright on the darkened map of `after`.
Image changeMap(const MeshTopology& topology, std::span<const uint8_t> before, std::span<const uint8_t> after,
                int side);
// Colour swatches with names, stacked.
Image cameraLegend(const std::vector<std::string>& names, int width, int height);

// Heat map of one channel 0..255; black where `alpha` (RGBA picture of the same size) is below 128.
Image shareMap(const std::vector<uint8_t>& values, const Image& alpha);

// Composites RGBA over a grey; RGB is copied.
Image overGrey(const Image& image, uint8_t grey = 32);
Image scaledTo(const Image& image, int width, int height);  // area filter for reduction, cubic for enlargement
// Crop, clipped to the picture; pixels.
Image cropped(const Image& image, int x, int y, int width, int height);
// Bounding box of alpha >= 128, grown by a margin and clamped: x, y, width, height. The whole picture if all alpha is
// below.
std::array<int, 4> shownBox(const Image& rgba, int margin);

}  // namespace fourdvt::report

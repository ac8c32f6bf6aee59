// SPDX-License-Identifier: Apache-2.0
#include "bake/texels/camera_tile.h"

#include <algorithm>

#include "bake/cameras/camera_layout.h"
#include "bake/cameras/tile_fill.h"
#include "bake/texels/picture_crop.h"

namespace fourdvt::bake {

Image drawCameraTile(const package::CameraTile& tile, const Image& picture, const ColourMap* map) {
  const package::Rect& source = tile.source;
  Image crop(source.width, source.height, 4);
  for (int y = 0; y < source.height; ++y)
    std::copy_n(picture.at(source.x, source.y + y), size_t(source.width) * 4, crop.at(0, y));
  replaceEdgeColours(crop);
  if (map) applyColours(*map, crop);
  const package::Rect cells = cellsOf(tile.tile);
  return drawTile(crop, {tile.tile.width, tile.tile.height}, {cells.width, cells.height});
}

}  // namespace fourdvt::bake

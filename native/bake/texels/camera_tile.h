// SPDX-License-Identifier: Apache-2.0
// Pixels of a camera's tile, from its picture.
#pragma once

#include "bake/texels/colour_calibration.h"
#include "base/image.h"
#include "package/surface_chunk.h"

namespace fourdvt::bake {

// The tile's source, without the backdrop's colour in the matte's edge, corrected by the map (null: as it is), and
// filled round the performer. RGB, cellsOf(tile.tile) in size. picture: RGBA with straight alpha.
Image drawCameraTile(const package::CameraTile& tile, const Image& picture, const ColourMap* map);

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Cuts out of a captured picture what the GPU or a tiled picture needs: the mesh's surroundings, without the backdrop's
// colour at the matte's edge. Uses no GL, so that any thread may call it.
#pragma once

#include <vector>

#include "bake/texels/colour_calibration.h"
#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"
#include "package/surface_chunk.h"

namespace fourdvt::bake {

constexpr uint8_t kOpaque = 250;  // least alpha of a pixel without the backdrop's colour

struct PictureCrop {
  PictureRegion region;                // of the mesh; empty if it is out of sight
  std::vector<uint8_t> premultiplied;  // height × width × 4
};

// `picture` is RGBA with the camera's size, with colours as recorded: mixed with the backdrop where alpha is partial.
PictureCrop cropPicture(const PinholeCamera& camera, const Positions& positions, const Image& picture);

// Edge pixels (alpha > 0 within two pixels of a pixel that is not opaque: mixed pixels and 4:2:0 chroma bleeding) take
// the mean colour of the opaque pixels further inside. Alpha stays. Structures too thin to have an inside stay as
// recorded.
void replaceEdgeColours(Image& rgba);

// Pixels of a camera's tile, from its picture: the tile's source, without the backdrop's colour in the matte's edge,
// corrected by the map (null: as it is), and filled round the performer. RGB, cellsOf(tile.tile) in size. picture: RGBA
// with straight alpha.
Image drawCameraTile(const package::CameraTile& tile, const Image& picture, const ColourMap* map);

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Crops of captured pictures for the GPU and for tiled pictures: the mesh's surroundings, without the backdrop's
// colour at the matte's edge. CPU only: any thread may call it.
#pragma once

#include <vector>

#include "bake/texels/colour_calibration.h"
#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"
#include "package/surface_chunk.h"

namespace fourdvt::bake {

constexpr uint8_t kOpaque = 250;  // minimum alpha of a pixel that is free of the backdrop's colour

struct PictureCrop {
  PictureRegion region;                // bounds of the mesh; empty if it is out of sight
  std::vector<uint8_t> premultiplied;  // height × width × 4
};

// `picture` is RGBA with the camera's size, with colours as recorded: mixed with the backdrop where alpha is partial.
PictureCrop cropPicture(const PinholeCamera& camera, const Positions& positions, const Image& picture);

// Replaces the colour of edge pixels (alpha > 0 within two pixels of a pixel that is not opaque: mixed pixels and
// 4:2:0 chroma bleeding) by the mean colour of the opaque pixels further inside. Alpha is unchanged, and so are
// structures too thin to have an inside.
void replaceEdgeColours(Image& rgba);

// Pixels of a camera's tile, from its picture: the tile's source, without the backdrop's colour at the matte's edge,
// corrected by the map (null: uncorrected), and filled outside the matte. RGB, cellsOf(tile.tile) in size. picture:
// RGBA with straight alpha.
Image drawCameraTile(const package::CameraTile& tile, const Image& picture, const ColourMap* map);

}  // namespace fourdvt::bake

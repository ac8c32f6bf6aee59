// SPDX-License-Identifier: Apache-2.0
// What lies in a tile: the performer as the camera shows him, and round him a smooth continuation of his colours,
// which lets texture filters and surfaces reach over his outline, and then mid-grey, which costs a codec nothing.
#pragma once

#include <glm/glm.hpp>

#include "base/image.h"

namespace fourdvt::bake {

// source: RGBA with straight alpha (the matte), colours of the performer alone wherever alpha is above 0. It is drawn
// into `tile` texels at the top left of a picture of `cells` texels, by the mean of the pixels that a texel covers;
// what alpha leaves open, and what lies beyond the tile, is filled. RGB.
Image drawTile(const Image& source, const glm::ivec2& tile, const glm::ivec2& cells);

}  // namespace fourdvt::bake

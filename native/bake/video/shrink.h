// SPDX-License-Identifier: Apache-2.0
// Smaller copies of layers and tiles, for renditions with fewer texels.
#pragma once

#include "base/image.h"

namespace fourdvt::bake {

// Every texel is the mean of the area that it covers, in encoded RGB. width, height: at most those of `source`. Reads
// `source` alone, so that what lies beside it in a tiled picture does not bleed in. RGB.
Image shrunk(const Image& source, int width, int height);

}  // namespace fourdvt::bake

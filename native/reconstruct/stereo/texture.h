// SPDX-License-Identifier: Apache-2.0
// How much a picture shows that stereo can match. Does NOT look at other pictures.
#pragma once

#include <vector>

#include "base/image.h"
#include "reconstruct/stereo/depth_map.h"

namespace fourdvt::reconstruct {

// Per pixel of an RGBA picture whose alpha is the matte, height × width: 0 where the surroundings show nothing but
// noise and slow shading, towards 1 where they are full of contrast. Pixels beside the outline do not count: the
// backdrop's colour and the codec reach into them.
std::vector<float> textureOf(const Image& rgba);

// Multiplies the weights of a map with what its camera's picture shows there, and forgets depths where that is nothing.
void weighByTexture(const Image& rgba, DepthMap& map);

}  // namespace fourdvt::reconstruct

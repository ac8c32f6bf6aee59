// SPDX-License-Identifier: Apache-2.0
// Light from all sides as nine coefficients of spherical harmonics a colour channel, of which a matte surface shows
// nearly all (M4D 6.2; the cosine's share of each order: RH01). Colours are
// sRGB-encoded 0..1 as everywhere: half of the range is the light that changes nothing.
// Frame of directions: x to the viewer's right, y up, z towards the viewer.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>

#include "base/result.h"

namespace fourdvt::render {

// Of the light that a surface gets: coefficients of radiance times the cosine's share, so that evenly lit surfaces have
// the colour of the light. Order: (0,0), (1,-1), (1,0), (1,1), (2,-2) … (2,2).
using Light = std::array<glm::vec3, 9>;

// What a surface gets that faces `direction` (unit). Not clamped.
glm::vec3 lightAt(const Light& light, const glm::vec3& direction);

// From an equirectangular picture: its middle lies straight ahead of the viewer, its right half to the right, its top
// row above. pixels: rows from the top, `channels` 3 or 4 bytes a pixel. Errors: InvalidArgument: not twice as wide as
// it is high, by a pixel.
Result<Light> lightFromPicture(std::span<const uint8_t> pixels, int width, int height, int channels);

// For those who give no picture: a warm light from the upper left before the figure, a cool one behind it.
Light studioLight();

}  // namespace fourdvt::render

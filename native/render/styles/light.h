// SPDX-License-Identifier: Apache-2.0
// Environment light as nine spherical harmonics coefficients per colour channel, which capture nearly all of a diffuse
// surface's shading (M4D 6.2). Cosine factors of each order: RH01 (Ravi Ramamoorthi, Pat Hanrahan: An Efficient
// Representation for Irradiance Environment Maps. SIGGRAPH, 2001). Colours are sRGB-encoded 0..1 as everywhere: half of
// the range is neutral light. Frame of directions: x to the viewer's right, y up, z towards the viewer.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>

#include "base/result.h"

namespace fourdvt::render {

// Irradiance coefficients: radiance times the cosine factor, normalised so that under even light surfaces have the
// colour of the light. Order: (0,0), (1,-1), (1,0), (1,1), (2,-2) … (2,2).
using Light = std::array<glm::vec3, 9>;

// Returns the light on a surface with unit normal `direction`, unclamped.
glm::vec3 lightAt(const Light& light, const glm::vec3& direction);

// Projects an equirectangular picture: its middle lies straight ahead of the viewer, its right half to the right, its
// top row above. pixels: rows from the top, `channels` 3 or 4 bytes a pixel. Errors: InvalidArgument: width differs
// from twice the height by more than a pixel.
Result<Light> lightFromPicture(std::span<const uint8_t> pixels, int width, int height, int channels);

// Default light: warm from the upper left before the figure, cool from behind it.
Light studioLight();

}  // namespace fourdvt::render

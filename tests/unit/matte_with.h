// SPDX-License-Identifier: Apache-2.0
// Valid mattes: neither empty nor full.
#pragma once

#include <cstdint>

#include "base/image.h"

namespace fourdvt {

// Matte of all but the outermost pixels; pixel (3, 3) has `value`.
inline Image matteWith(uint8_t value, int width, int height) {
  Image out(width, height, 1);
  for (int y = 1; y + 1 < height; ++y)
    for (int x = 1; x + 1 < width; ++x) *out.at(x, y) = 255;
  *out.at(3, 3) = value;
  return out;
}

}  // namespace fourdvt

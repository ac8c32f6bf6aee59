// SPDX-License-Identifier: Apache-2.0
// Mattes that can be meant: neither empty nor of the whole picture.
#pragma once

#include <cstdint>

#include "base/image.h"

namespace fourdvt {

// A matte that keeps all but the outermost pixels; (3, 3) has a value of its own.
inline Image matteWith(uint8_t value, int width, int height) {
  Image out(width, height, 1);
  for (int y = 1; y + 1 < height; ++y)
    for (int x = 1; x + 1 < width; ++x) *out.at(x, y) = 255;
  *out.at(3, 3) = value;
  return out;
}

}  // namespace fourdvt

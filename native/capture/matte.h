// SPDX-License-Identifier: Apache-2.0
// Chroma key: a matte from a picture and the empty studio's plate. Does NOT remove colour spill.
#pragma once

#include "base/image.h"

namespace fourdvt::capture {

// Distances in the CbCr plane (BT.709, full range), levels of 255.
struct ChromaKeyOptions {
  float background_below = 9;   // alpha 0
  float foreground_above = 30;  // alpha 255; soft ramp between
};

// `picture` and `plate`: 3 channels, equal size. 1 channel, 255 where foreground. Specks of up to two pixels and
// pinholes are cleaned away.
Image chromaKey(const Image& picture, const Image& plate, const ChromaKeyOptions& options = {});

}  // namespace fourdvt::capture

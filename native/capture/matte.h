// SPDX-License-Identifier: Apache-2.0
// Chroma key: derives a matte from a picture and a plate of the empty studio. Does NOT remove colour spill.
#pragma once

#include "base/image.h"

namespace fourdvt::capture {

// Distances between picture and plate in the CbCr plane (BT.709, full range), in levels of 255.
struct ChromaKeyOptions {
  float background_below = 9;   // alpha 0
  float foreground_above = 30;  // alpha 255; a soft ramp lies between the two
};

// `picture` and `plate` have 3 channels and equal sizes. Returns 1 channel, 255 in the foreground, without specks of up
// to two pixels and without pinholes.
Image chromaKey(const Image& picture, const Image& plate, const ChromaKeyOptions& options = {});

}  // namespace fourdvt::capture

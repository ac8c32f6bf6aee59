// SPDX-License-Identifier: Apache-2.0
// Mattes in front of a natural background: tells what was not in the room when its plates were taken, in front of walls
// and floors of any texture, with the object's shadows and highlights counted as background. The room and the camera
// must stand still, and exposure and white balance must be those of the plates: see fitPlate. Does NOT look at other
// cameras or other frames, and does NOT remove colour spill. Method and sources: algorithms/mattes.md.
#pragma once

#include <span>

#include "base/image.h"
#include "capture/background_model.h"

namespace fourdvt::capture {

struct BackgroundKeyOptions {
  float min_shadow = 0.2f;      // background may be darker than its plate down to this ratio (encoded values)
  float max_highlight = 1.25f;  // … and brighter up to this one
  float smoothness = 2.2f;      // cost of a border between object and background per pixel of its length, in nats
  int rounds = 2;               // how often the object's colours and the shadow's ratio are learnt anew
  float speck_share = 1e-4f;    // parts and holes of less than this share of the picture, or of less than 12 pixels, go
  float blur_pixels = 0.7f;     // the outline's softness where picture and plate do not tell it
};

// `picture` has 3 channels and the plates' size. Returns 1 channel, 255 on the object, with a ramp of about a pixel at
// its outline; all 0 if nothing stands in front of the background. Holes, e.g. between arm and body, stay holes.
Image backgroundKey(const Image& picture, const BackgroundModel& background, const BackgroundKeyOptions& options = {});

}  // namespace fourdvt::capture

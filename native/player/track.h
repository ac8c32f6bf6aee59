// SPDX-License-Identifier: Apache-2.0
// One sequence that is being played by one decoder: the parts that each track has of its own. A player has two tracks;
// the second is used only around a transition. Does nothing itself: the player brings the parts together.
#pragma once

#include "player/parts/feeding.h"
#include "player/parts/figure_composer.h"
#include "player/parts/parameters.h"
#include "player/parts/picture_slots.h"
#include "player/parts/playhead.h"
#include "player/parts/root_motion.h"

namespace fourdvt {

struct Track {
  Track(int decoder, int picture_slots, render::PictureTextures::Kind kind, size_t samples_ahead)
      : feeding(decoder, samples_ahead), slots(picture_slots, kind) {}

  Playhead head;
  Feeding feeding;
  PictureSlots slots;
  ShownParameters parameters;
  RootTrail roots;
  ShownFrame frame;
};

}  // namespace fourdvt

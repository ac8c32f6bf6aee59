// SPDX-License-Identifier: Apache-2.0
// How well feet stand on the ground while a character travels along a root track (class_plan.h rootTrack).
#pragma once

#include <vector>

#include "bake/motion/class_plan.h"

namespace fourdvt::bake {

struct FootSkate {
  int contacts = 0;  // of single vertices: at least three frames near the ground, not swung
  // How far a contact's vertex strays over the ground, first to last extreme: mean, 95th percentile, largest.
  double mean_m = 0, most_m = 0, max_m = 0;
};

// track: as of rootTrack, without turns.
Result<FootSkate> footSkate(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                            const std::vector<glm::vec3>& track, const ReadPositions& read);

}  // namespace fourdvt::bake

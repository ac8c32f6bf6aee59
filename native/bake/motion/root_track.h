// SPDX-License-Identifier: Apache-2.0
// Root track of a character over the ground, from its meshes alone (algorithms/motion.md), and the residual sliding
// of its feet. Turns are not measured.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capture/capture.h"

namespace fourdvt::bake {

// Positions of one captured frame in the decoded mesh's order, metres.
using ReadPositions = std::function<Result<Positions>(const capture::CaptureSequence&, uint32_t frame)>;

// The root track of a captured sequence: [frame_count + 1], metres along x and z and radians about y since frame 0;
// the last entry is the whole pass, the angle is always 0. Minimises the sliding of vertices that stand on the
// ground, and keeps the velocity between contacts. If the feet's mean speed and a declared root velocity differ by
// more than a fifth, the declared velocity is used and reported in `note`.
Result<std::vector<glm::vec3>> rootTrack(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                                         const ReadPositions& read, std::string* note = nullptr);

struct FootSkate {
  int contacts = 0;  // stretches of at least three frames in which one vertex stands on the ground
  // Sliding distance of a vertex during a contact, between its extremes: mean, 95th percentile, maximum.
  double mean_m = 0, tail_m = 0, max_m = 0;
};

// `track`: from rootTrack; turns are ignored.
Result<FootSkate> footSkate(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                            const std::vector<glm::vec3>& track, const ReadPositions& read);

// Captured frames at which a foot touches down, ascending: the first of a stretch of frames in which vertices come to
// a stand on the ground. `track`: from rootTrack. Feet that stand in frame 0 of a motion that is no loop are excluded.
Result<std::vector<uint32_t>> footfalls(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                                        const std::vector<glm::vec3>& track, const ReadPositions& read);

}  // namespace fourdvt::bake

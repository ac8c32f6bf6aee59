// SPDX-License-Identifier: Apache-2.0
// One face's ordered tuple of distinct cameras, and the sorted tuple that "naive" and every start of a solve use.
#pragma once

#include <array>
#include <cstdint>

#include "bake/labels/face_costs.h"
#include "package/character.h"

namespace fourdvt::bake {

struct LabelTuple {
  std::array<uint8_t, package::kMaxLayers> ranks;  // camera or package::kNoCamera
  LabelTuple() { ranks.fill(package::kNoCamera); }
  bool operator==(const LabelTuple& o) const { return ranks == o.ranks; }
};

// The `count` cheapest cameras of `allowed`, the cheapest first; equal penalties are ordered by camera index.
inline LabelTuple cheapestCameras(const FaceCosts& costs, size_t face, uint32_t allowed, int count) {
  LabelTuple out;
  const float* penalties = costs.penalty.data() + face * costs.camera_count;
  for (int rank = 0; rank < count && allowed; ++rank) {
    int best = -1;
    for (int c = 0; c < costs.camera_count; ++c)
      if ((allowed >> c & 1) && (best < 0 || penalties[c] < penalties[best])) best = c;
    out.ranks[rank] = static_cast<uint8_t>(best);
    allowed &= ~(1u << best);
  }
  return out;
}

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Partition of the tree of similar frames into paths, for processes that fit them concurrently.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "track/order.h"

namespace fourdvt::track {

// Frames of a path down the tree, each one the parent of the next.
struct FramePath {
  uint32_t parent = 0;           // the first frame's parent; the root is its own
  std::vector<uint32_t> frames;  // not empty
};

// Paths in topological order that contain every frame once. At a branching, a path continues towards the deepest leaf;
// the other branches begin paths of their own. `steps`: see trackingOrder.
std::vector<FramePath> framePaths(std::span<const TrackingStep> steps, size_t max_frames);

}  // namespace fourdvt::track

// SPDX-License-Identifier: Apache-2.0
#include "track/frame_paths.h"

namespace fourdvt::track {

std::vector<FramePath> framePaths(std::span<const TrackingStep> steps, size_t max_frames) {
  const size_t count = steps.size();
  std::vector<uint32_t> heights(count, 0), deepest_child(count, 0);
  for (size_t i = count; i-- > 1;) {
    const auto [frame, parent] = std::pair(steps[i].frame, steps[i].parent);
    if (heights[frame] + 1 < heights[parent]) continue;
    heights[parent] = heights[frame] + 1, deepest_child[parent] = frame;
  }
  std::vector<FramePath> out;
  std::vector<size_t> path_of(count, 0);
  for (const TrackingStep& step : steps) {
    const bool root = step.frame == step.parent;
    const size_t above = path_of[step.parent];
    const bool continues = !root && deepest_child[step.parent] == step.frame && out[above].frames.size() < max_frames;
    if (!continues) out.push_back({step.parent, {}});
    path_of[step.frame] = continues ? above : out.size() - 1;
    out[path_of[step.frame]].frames.push_back(step.frame);
  }
  return out;
}

}  // namespace fourdvt::track

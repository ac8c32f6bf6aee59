// SPDX-License-Identifier: Apache-2.0
// How far texture coordinates may move before they leave what the gutter of their chart holds.
#pragma once

#include <span>
#include <vector>

#include "base/surface_frame.h"

namespace fourdvt::bake {

class ChartLimits {
 public:
  // `size`: side of layer 1 in texels. Topology and frames are borrowed.
  ChartLimits(const MeshTopology& topology, const SurfaceFrames& frames, int size, int gutter_texels);
  // Shortens every displacement (metres along the tangents) that would move the texture coordinates of a corner,
  // forwards or backwards, beyond the gutter of their chart or into the gutter of another chart.
  void cut(std::vector<glm::vec2>& displacement_m) const;
  int size() const { return size_; }

 private:
  // Largest share of `shift` (texture coordinates) that stays in reach of the chart.
  float allowedShare(const glm::vec2& uv, const glm::vec2& shift, int chart) const;

  const MeshTopology* topology_;
  const SurfaceFrames* frames_;
  int size_ = 0;
  std::vector<int> chart_of_uv_;
  std::vector<int> reach_;  // size × size: the nearest chart within reach; kNoChart: none
};

}  // namespace fourdvt::bake

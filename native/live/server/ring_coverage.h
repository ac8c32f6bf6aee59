// SPDX-License-Identifier: Apache-2.0
// Share of each pixel that lies inside of an outline's rings: seen background. Exact areas, by the rings' winding. Does
// NOT repair rings that cross.
#pragma once

#include <vector>

#include "live/protocol/camera_messages.h"

namespace fourdvt::live {

class RingCoverage {
 public:
  // Pixels of a picture of width × height that shows `source` of the camera's picture, stretched to stretched_width ×
  // stretched_height at its top left. Valid until the next call: 0 performer … 1 background, row by row.
  const std::vector<float>& draw(const std::vector<Ring16>& rings, const package::Rect& source, int stretched_width,
                                 int stretched_height, int width, int height);

 private:
  void addEdge(double x0, double y0, double x1, double y1);
  void addRow(int y, double x0, double x1, double height);

  int width_ = 0, height_ = 0;
  std::vector<float> area_;  // differences along the row while drawing
};

}  // namespace fourdvt::live

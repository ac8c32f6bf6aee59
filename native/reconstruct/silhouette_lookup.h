// SPDX-License-Identifier: Apache-2.0
// Finds the wedges of one camera near points and lines of space, by rows of its picture.
#pragma once

#include <vector>

#include "reconstruct/hull_planes.h"

namespace fourdvt::reconstruct {

class SilhouetteLookup {
 public:
  SilhouetteLookup(const HullPlanes& planes, int camera, const PinholeCamera& pinhole);  // borrows the planes

  // Whether the camera lets the performer be there. Exact for outlines whose edges keep a hundredth of a pixel apart.
  // `scaled`: the point's position; 0 of PlanePoint::side() sets `tie`.
  bool mayHold(const PlanePoint& point, const glm::dvec3& scaled, bool& tie) const;

  // Appends the planes whose wedges the straight line from one scaled point to another may pass, each once.
  void candidates(const glm::dvec3& from, const glm::dvec3& to, std::vector<uint32_t>& found);

 private:
  int row(double y_px) const;
  bool mayHoldNear(uint32_t edge, const glm::dvec2& pixel, const PlanePoint& point, bool& tie) const;

  const HullPlanes& planes_;
  uint32_t first_;                  // the camera's first plane
  glm::dmat4 picture_from_scaled_;  // homogeneous pixels; the third entry is the depth, scaled
  double top_px_ = 0, bottom_px_ = 0, row_px_ = 1;
  struct RowEdge {
    double left_px, right_px;  // of the whole edge
    uint32_t plane;
  };
  std::vector<std::vector<RowEdge>> rows_;  // planes whose edges meet the row
  std::vector<uint32_t> stamp_;             // per wedge: the last question that found it
  uint32_t question_ = 0;
};

}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
// Polyhedral hull of one instant's outlines within a time limit (HullMaker), and exact coverage of pixels by rings
// (RingCoverage). Instants are independent of each other.
#pragma once

#include <span>
#include <vector>

#include "base/camera.h"
#include "base/mesh.h"
#include "base/result.h"
#include "live/protocol/camera_messages.h"
#include "silhouette/contour.h"

namespace fourdvt::live {
struct LiveHullRules {
  BoundingBox bounds;  // metres; reconstruction is limited to this box
  size_t max_triangles = 20000;
  double max_ms = 100;  // time limit after which no further attempt begins
};

struct LiveHull {
  TriangleMesh mesh;             // no faces: the outlines have no common volume
  std::vector<size_t> left_out;  // cameras whose outlines were unusable
  int attempts = 1;
};

silhouette::Outline outlineFrom(const std::vector<Ring16>& rings);

class HullMaker {
 public:
  // Errors: InvalidArgument (bounds; a camera within them or at another's position).
  static Result<HullMaker> create(std::vector<PinholeCamera> cameras, const LiveHullRules& rules);
  // rings: per camera; null: no picture of this instant. A camera without rings carves nothing. An unclosed hull is
  // retried with fewer points, then without one of the cameras. Errors: NothingVisible (fewer than two cameras carve),
  // Internal (no attempt closed).
  Result<LiveHull> make(std::span<const std::vector<Ring16>* const> rings) const;

 private:
  HullMaker(std::vector<PinholeCamera> cameras, const LiveHullRules& rules);
  // Removes components inside the pictures of fewer than half of `carving`, the hull's cameras, since nothing has
  // carved them; then hollows, specks and phantoms. Simplifies.
  void clean(std::span<const PinholeCamera> carving, TriangleMesh& mesh) const;

  std::vector<PinholeCamera> cameras_, small_cameras_;  // small: reduced cameras for the removal of phantoms
  LiveHullRules rules_;
};

// Share of each pixel inside an outline's rings, i.e. of visible background: exact areas by the rings' winding. Rings
// must not cross.
class RingCoverage {
 public:
  // Renders `source`, a rectangle of the camera's picture, stretched to stretched_width × stretched_height at the top
  // left of a picture of width × height. Returns 0 performer … 1 background, row by row, valid until the next call.
  const std::vector<float>& draw(const std::vector<Ring16>& rings, const package::Rect& source, int stretched_width,
                                 int stretched_height, int width, int height);

 private:
  void addEdge(double x0, double y0, double x1, double y1);
  void addRow(int y, double x0, double x1, double height);

  int width_ = 0, height_ = 0;
  std::vector<float> area_;  // differences along the row while drawing
};

}  // namespace fourdvt::live

// SPDX-License-Identifier: Apache-2.0
// The polyhedral hull of one instant's outlines, under the hurry of live use: what does not close is tried again with
// fewer points, then without one of the cameras. Does NOT keep anything from one instant to the next.
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
  BoundingBox bounds;  // metres; nothing outside is reconstructed
  size_t most_triangles = 20000;
  double most_ms = 100;  // after so long no further attempt begins
};

struct LiveHull {
  TriangleMesh mesh;             // no faces: all cameras together see nobody
  std::vector<size_t> left_out;  // cameras whose outlines were of no use
  int attempts = 1;
};

silhouette::Outline outlineFrom(const std::vector<Ring16>& rings);

class HullMaker {
 public:
  // Errors: InvalidArgument (bounds, or a camera that lies within them or where another one is).
  static Result<HullMaker> create(std::vector<PinholeCamera> cameras, const LiveHullRules& rules);
  // rings: per camera; null: it has no picture of this instant. A camera without rings carves nothing. Errors:
  // NothingVisible (fewer than two cameras carve), Internal (no attempt closed).
  Result<LiveHull> make(std::span<const std::vector<Ring16>* const> rings) const;

 private:
  HullMaker(std::vector<PinholeCamera> cameras, const LiveHullRules& rules);
  // carving: the cameras whose outlines made the mesh; what fewer than half of them see nothing has carved.
  void clean(std::span<const PinholeCamera> carving, TriangleMesh& mesh) const;

  std::vector<PinholeCamera> cameras_, small_cameras_;  // small: of reduced pictures, in which phantoms are judged
  LiveHullRules rules_;
};

// Share of each pixel that lies inside of an outline's rings: seen background. Exact areas, by the rings' winding. Does
// NOT repair rings that cross.

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

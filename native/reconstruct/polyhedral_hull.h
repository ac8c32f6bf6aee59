// SPDX-License-Identifier: Apache-2.0
// The polyhedral visual hull: what is left of a box when everything is cut away that cameras see as background (OVH03,
// section 4; FB09).
//
// Its faces lie in the planes through a camera's centre and an edge of its outline. Where planes meet is decided
// exactly, so the surface is closed, consistently oriented and does not cross itself beyond the rounding of positions
// to float. Does NOT carve behind a camera or outside its picture, and does NOT smooth or merge faces.
//
// Stages: hull_planes.h, hull_edges.h, hull_edges.h.
#pragma once

#include <span>

#include "base/camera.h"
#include "base/mesh.h"
#include "base/result.h"
#include "silhouette/contour.h"

namespace fourdvt::reconstruct {

// What a camera cuts away: everything in front of it that it sees inside of its outline's rings.
struct SilhouetteCone {
  PinholeCamera camera;
  silhouette::Outline outline;
};

struct PolyhedralHull {
  TriangleMesh mesh;            // no faces: nothing is left
  bool touches_bounds = false;  // some of the surface is not the cameras' but the box's
  int attempts = 1;             // 2 and more: planes met in one point and were rounded anew; 4 at most
};

// The hull inside of `bounds` (world, metres). Every camera must lie outside of the bounds and nowhere near another.
// Errors: InvalidArgument (see hullPlanes), Internal (the surface does not close, e.g. since the rings of an outline
// cross: take a volumetric hull instead).
Result<PolyhedralHull> polyhedralHull(std::span<const SilhouetteCone> cones, const BoundingBox& bounds);

}  // namespace fourdvt::reconstruct

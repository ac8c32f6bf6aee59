// SPDX-License-Identifier: Apache-2.0
// Polyhedral visual hull: a box minus all space that cameras see as background. Faces lie in the planes through a
// camera's centre and an edge of its outline. Predicates on planes are exact, so that the surface is closed,
// consistently oriented and free of self-intersections except for rounding of positions to float. Space behind cameras
// and outside their pictures is not carved. Stages: hull_planes.h, hull_edges.h (Franco and Boyer 2009).
//
// Source: Ming Li, Marcus Magnor, Hans-Peter Seidel: Online Accelerated Rendering of Visual Hulls in Real Scenes.
// Journal of WSCG 11, 2003; section 4.
#pragma once

#include <span>

#include "base/camera.h"
#include "base/mesh.h"
#include "base/result.h"
#include "silhouette/contour.h"

namespace fourdvt::reconstruct {

// Space carved by a camera: all in front of it that projects into its outline's rings.
struct SilhouetteCone {
  PinholeCamera camera;
  silhouette::Outline outline;
};

struct PolyhedralHull {
  TriangleMesh mesh;            // no faces: the hull is empty
  bool touches_bounds = false;  // part of the surface lies on the box
  int attempts = 1;             // roundings of the planes until they were in general position; at most 4
};

// Computes the hull inside `bounds` (world, metres). Cameras must lie outside the bounds and apart from each other.
// Errors: InvalidArgument (see hullPlanes), Internal (the surface does not close, e.g. because rings of an outline
// cross; a volumetric hull is the fallback).
Result<PolyhedralHull> polyhedralHull(std::span<const SilhouetteCone> cones, const BoundingBox& bounds);

}  // namespace fourdvt::reconstruct

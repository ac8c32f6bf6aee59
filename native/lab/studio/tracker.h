// SPDX-License-Identifier: Apache-2.0
// Mesh that a capture system would track on an actor: each vertex is attached to a point of the surface. The point may
// slide over the surface with the motion ("drift"), and the vertex may stand off the surface ("proxy error"). Provides
// the exact correspondence between motions.
#pragma once

#include "lab/studio/actors/actor.h"
#include "lab/studio/actors/surface.h"
#include "lab/studio/studio.h"

namespace fourdvt::studio {

class Tracker {
 public:
  Tracker(const Actor& actor, const StudioKnobs& knobs);

  const Surface& actorSurface() const { return actor_surface_; }
  const Surface& trackedSurface() const { return tracked_surface_; }
  // [vertex] point of the actor's surface, its material, under the tracked vertex. `place`: position between the first
  // (0) and last (1) member of the class. At phase 0 the points of places 0 and 1 are up to knobs.drift_mm apart along
  // the surface.
  std::vector<SurfacePoint> points(double place, double phase) const;
  // Tracked mesh for a pose of the surface: exact, or with the proxy error.
  Positions truth(const std::vector<SurfacePoint>& points, const Positions& pose) const;
  Positions captured(const std::vector<SurfacePoint>& points, const Positions& pose) const;
  // [vertex] point of the tracked mesh that carries at place `to` the vertex's material at `from`: the true alignment
  // of their appearance.
  std::vector<SurfacePoint> alignment(double from, double to, double phase) const;
  // Tangent field of the drift, of length at most 1, at a tracked vertex in the rest pose.
  glm::dvec3 driftDirection(uint32_t vertex) const;

 private:
  SurfacePoint aligned(uint32_t vertex, const glm::dvec3& material, const Positions& materials) const;

  const StudioKnobs knobs_;
  const Surface actor_surface_, tracked_surface_;
  std::vector<SurfacePoint> base_;  // [tracked vertex] on the actor's surface
  std::vector<glm::dvec3> drift_;   // [tracked vertex] driftDirection
  std::vector<double> offset_;      // [tracked vertex] proxy error, metres
};

}  // namespace fourdvt::studio

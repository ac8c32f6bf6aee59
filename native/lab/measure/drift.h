// SPDX-License-Identifier: Apache-2.0
// Drift of a tracked mesh against a reference mesh whose vertices are material points. The tracked mesh's vertices are
// bound to places of the reference's surface in one frame; the error of a vertex in another frame is its displacement
// from that place.
#pragma once

#include <cstdint>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::measure {

struct BindingLimits {
  double within_m = 0.015;  // maximum distance of a bound vertex from the reference
  double min_cosine = 0.5;  // minimum cosine between the vertex's normal and the surface's, interpolated
};

// Places of a tracked mesh's vertices on a reference surface. A place is the nearest point of the surface and the
// vertex's offset from it in axes that turn with the surface: two tangents and the interpolated normal.
class SurfaceBinding {
 public:
  // Both meshes at the same instant. Requires valid indices and finite positions.
  SurfaceBinding(const TriangleMesh& tracked, const TriangleMesh& reference, const BindingLimits& limits = {});

  const std::vector<uint32_t>& vertices() const { return vertices_; }  // bound vertices, ascending
  size_t far() const { return far_; }                                  // vertices beyond the maximum distance
  size_t facingAway() const { return facing_away_; }                   // others below the minimum cosine

  // [bound vertex] error in metres at an instant of both meshes: two tangential components, then the normal one. 0 at
  // the instant of the binding.
  std::vector<glm::dvec3> errors(const Positions& tracked, const Positions& reference) const;

 private:
  struct Place {
    glm::uvec3 corners;
    glm::dvec3 share;   // barycentric
    glm::dvec3 offset;  // along the surface's axes
  };
  // Axes of the surface: columns are two tangents and the normal.
  struct Axes {
    glm::dvec3 origin;
    glm::dmat3 world_from_axes;
  };
  static Axes axesAt(const Place& place, const Positions& reference, const std::vector<glm::vec3>& normals);

  std::vector<glm::uvec3> faces_;  // the reference's
  std::vector<uint32_t> vertices_;
  std::vector<Place> places_;  // [bound vertex]
  size_t far_ = 0, facing_away_ = 0;
};

// Root mean square over the vertices of the change of the error between two frames, metres. 0 without vertices.
double errorChange_m(const std::vector<glm::dvec3>& errors, const std::vector<glm::dvec3>& next);

// Lengths over vertices and frames, metres; changes over pairs of successive frames.
struct DriftFigures {
  double mean_m = 0, median_m = 0, p95_m = 0, p99_m = 0, max_m = 0;
  double tangential_mean_m = 0, normal_mean_m = 0;  // mean absolute components
  double change_mean_m = 0, change_p95_m = 0;       // errorChange_m
};

// Collects the errors of frames.
class DriftSamples {
 public:
  void add(const std::vector<glm::dvec3>& errors);
  void addChange(double change_m) { changes_m_.push_back(change_m); }
  void add(const DriftSamples& other);
  DriftFigures figures() const;  // zeros without samples

 private:
  std::vector<double> lengths_m_, changes_m_;
  double tangential_m_ = 0, normal_m_ = 0;  // sums
};

}  // namespace fourdvt::measure

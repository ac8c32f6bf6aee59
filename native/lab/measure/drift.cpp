// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/drift.h"

#include <algorithm>
#include <cmath>

#include "base/robust.h"
#include "track/mesh/nearest.h"

namespace fourdvt::measure {
namespace {

glm::dvec3 weighted(const glm::uvec3& corners, const glm::dvec3& share, const std::vector<glm::vec3>& of) {
  return share.x * glm::dvec3(of[corners.x]) + share.y * glm::dvec3(of[corners.y]) +
         share.z * glm::dvec3(of[corners.z]);
}

// Unit vector, or `otherwise` for one without a direction.
glm::dvec3 unit(const glm::dvec3& v, const glm::dvec3& otherwise) {
  const double length = glm::length(v);
  return length > 1e-12 ? v / length : otherwise;
}

glm::dvec3 anyAcross(const glm::dvec3& normal) {
  const glm::dvec3 axis = std::abs(normal.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(axis - glm::dot(axis, normal) * normal);
}

double tangential(const glm::dvec3& error) { return std::hypot(error.x, error.y); }

}  // namespace

SurfaceBinding::Axes SurfaceBinding::axesAt(const Place& place, const Positions& reference,
                                            const std::vector<glm::vec3>& normals) {
  const glm::dvec3 normal = unit(weighted(place.corners, place.share, normals), {0, 1, 0});
  const glm::dvec3 side = glm::dvec3(reference[place.corners.y]) - glm::dvec3(reference[place.corners.x]);
  const glm::dvec3 tangent = unit(side - glm::dot(side, normal) * normal, anyAcross(normal));
  return {weighted(place.corners, place.share, reference), {tangent, glm::cross(normal, tangent), normal}};
}

SurfaceBinding::SurfaceBinding(const TriangleMesh& tracked, const TriangleMesh& reference, const BindingLimits& limits)
    : faces_(reference.faces) {
  const track::NearestSurface surface(reference);
  std::vector<glm::vec3> tracked_normals, normals;
  computeVertexNormals(tracked.faces, tracked.positions.data(), tracked.positions.size(), tracked_normals);
  computeVertexNormals(faces_, reference.positions.data(), reference.positions.size(), normals);
  for (uint32_t v = 0; v < tracked.positions.size(); ++v) {
    const auto hit = surface.nearest(tracked.positions[v], float(limits.within_m));
    if (!hit) {
      ++far_;
      continue;
    }
    Place place{faces_[hit->face], glm::dvec3(hit->barycentric), {}};
    const Axes axes = axesAt(place, reference.positions, normals);
    if (glm::dot(axes.world_from_axes[2], glm::dvec3(tracked_normals[v])) < limits.min_cosine) {
      ++facing_away_;
      continue;
    }
    place.offset = glm::transpose(axes.world_from_axes) * (glm::dvec3(tracked.positions[v]) - axes.origin);
    vertices_.push_back(v);
    places_.push_back(place);
  }
}

std::vector<glm::dvec3> SurfaceBinding::errors(const Positions& tracked, const Positions& reference) const {
  std::vector<glm::vec3> normals;
  computeVertexNormals(faces_, reference.data(), reference.size(), normals);
  std::vector<glm::dvec3> out;
  out.reserve(vertices_.size());
  for (size_t i = 0; i < vertices_.size(); ++i) {
    const Axes axes = axesAt(places_[i], reference, normals);
    const glm::dvec3 from_origin = glm::dvec3(tracked[vertices_[i]]) - axes.origin;
    out.push_back(glm::transpose(axes.world_from_axes) * from_origin - places_[i].offset);
  }
  return out;
}

double errorChange_m(const std::vector<glm::dvec3>& errors, const std::vector<glm::dvec3>& next) {
  double sum = 0;
  for (size_t i = 0; i < errors.size(); ++i) sum += glm::dot(next[i] - errors[i], next[i] - errors[i]);
  return errors.empty() ? 0 : std::sqrt(sum / double(errors.size()));
}

void DriftSamples::add(const std::vector<glm::dvec3>& errors) {
  for (const glm::dvec3& error : errors) {
    lengths_m_.push_back(glm::length(error));
    tangential_m_ += tangential(error);
    normal_m_ += std::abs(error.z);
  }
}

void DriftSamples::add(const DriftSamples& other) {
  lengths_m_.insert(lengths_m_.end(), other.lengths_m_.begin(), other.lengths_m_.end());
  changes_m_.insert(changes_m_.end(), other.changes_m_.begin(), other.changes_m_.end());
  tangential_m_ += other.tangential_m_;
  normal_m_ += other.normal_m_;
}

DriftFigures DriftSamples::figures() const {
  DriftFigures out;
  if (lengths_m_.empty()) return out;
  const auto count = double(lengths_m_.size());
  for (const double length : lengths_m_) {
    out.mean_m += length / count;
    out.max_m = std::max(out.max_m, length);
  }
  out.median_m = quantile(lengths_m_, 0.5);
  out.p95_m = quantile(lengths_m_, 0.95);
  out.p99_m = quantile(lengths_m_, 0.99);
  out.tangential_mean_m = tangential_m_ / count;
  out.normal_mean_m = normal_m_ / count;
  for (const double change : changes_m_) out.change_mean_m += change / double(changes_m_.size());
  out.change_p95_m = quantile(changes_m_, 0.95);
  return out;
}

}  // namespace fourdvt::measure

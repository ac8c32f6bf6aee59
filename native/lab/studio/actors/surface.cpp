// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/actors/surface.h"

#include <algorithm>
#include <limits>
#include <map>

namespace fourdvt::studio {
namespace {

constexpr int kMaxCrossings = 10000;

// Barycentric coordinates of the closest point of a triangle, by clamping to its edges.
glm::dvec3 closestShare(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 n = glm::cross(b - a, c - a);
  const double area = glm::dot(n, n);
  if (area > 0) {
    const glm::dvec3 s(glm::dot(n, glm::cross(c - b, p - b)) / area, glm::dot(n, glm::cross(a - c, p - c)) / area,
                       glm::dot(n, glm::cross(b - a, p - a)) / area);
    if (s.x >= 0 && s.y >= 0 && s.z >= 0) return s;
  }
  const glm::dvec3 corners[3] = {a, b, c};
  glm::dvec3 best(1, 0, 0);
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 edge = corners[(k + 1) % 3] - corners[k];
    const double t = std::clamp(glm::dot(p - corners[k], edge) / std::max(glm::dot(edge, edge), 1e-300), 0.0, 1.0);
    const double distance = glm::length(p - corners[k] - t * edge);
    if (distance >= nearest) continue;
    nearest = distance;
    best = glm::dvec3(0);
    best[k] = 1 - t;
    best[(k + 1) % 3] = t;
  }
  return best;
}

}  // namespace

Surface::Surface(std::vector<glm::uvec3> faces, Positions positions)
    : faces_(std::move(faces)), positions_(std::move(positions)), vertex_faces_(positions_.size()) {
  computeVertexNormals(faces_, positions_.data(), positions_.size(), normals_);
  neighbours_.assign(faces_.size(), {-1, -1, -1});
  std::map<std::pair<uint32_t, uint32_t>, std::pair<uint32_t, int>> open;
  for (uint32_t f = 0; f < faces_.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      vertex_faces_[faces_[f][k]].push_back(f);
      const uint32_t a = faces_[f][(k + 1) % 3], b = faces_[f][(k + 2) % 3];
      const auto key = std::minmax(a, b);
      const auto found = open.find(key);
      if (found == open.end()) {
        open[key] = {f, k};
        continue;
      }
      neighbours_[f][k] = static_cast<int>(found->second.first);
      neighbours_[found->second.first][found->second.second] = static_cast<int>(f);
      open.erase(found);
    }
}

SurfacePoint Surface::atVertex(uint32_t vertex) const {
  if (vertex_faces_[vertex].empty()) return {};
  SurfacePoint point{vertex_faces_[vertex][0], glm::dvec3(0)};
  for (int k = 0; k < 3; ++k)
    if (faces_[point.face][k] == vertex) point.share[k] = 1;
  return point;
}

SurfacePoint Surface::nearest(const glm::dvec3& p) const {
  uint32_t vertex = 0;
  double least = std::numeric_limits<double>::infinity();
  for (uint32_t v = 0; v < positions_.size(); ++v) {
    const glm::dvec3 d = glm::dvec3(positions_[v]) - p;
    if (vertex_faces_[v].empty() || glm::dot(d, d) >= least) continue;
    least = glm::dot(d, d);
    vertex = v;
  }
  SurfacePoint best = atVertex(vertex);
  for (const uint32_t f : vertex_faces_[vertex]) {
    const SurfacePoint point{f, closestShare(p, corner(f, 0), corner(f, 1), corner(f, 2))};
    const glm::dvec3 d = place(point, positions_) - p;
    if (glm::dot(d, d) < least) least = glm::dot(d, d), best = point;
  }
  return best;
}

glm::dvec3 Surface::place(const SurfacePoint& point, const Positions& pose) const {
  const glm::uvec3& face = faces_[point.face];
  return point.share.x * glm::dvec3(pose[face.x]) + point.share.y * glm::dvec3(pose[face.y]) +
         point.share.z * glm::dvec3(pose[face.z]);
}

glm::dvec3 Surface::faceNormal(uint32_t f) const {
  const glm::dvec3 n = glm::cross(corner(f, 1) - corner(f, 0), corner(f, 2) - corner(f, 0));
  const double length = glm::length(n);
  return length > 0 ? n / length : glm::dvec3(0, 1, 0);
}

// Change of the barycentric coordinates per unit of a direction in the face's plane.
glm::dvec3 Surface::shareRate(uint32_t f, const glm::dvec3& direction) const {
  const glm::dvec3 a = corner(f, 0), b = corner(f, 1), c = corner(f, 2);
  const glm::dvec3 n = glm::cross(b - a, c - a);
  const double area = std::max(glm::dot(n, n), 1e-300);
  return {glm::dot(n, glm::cross(c - b, direction)) / area, glm::dot(n, glm::cross(a - c, direction)) / area,
          glm::dot(n, glm::cross(b - a, direction)) / area};
}

// Steps into the face behind the edge opposite to corner `opposite` and unfolds the direction. Returns false for an
// open edge.
bool Surface::cross(SurfacePoint& at, int opposite, glm::dvec3& direction) const {
  const int next = neighbours_[at.face][opposite];
  if (next < 0) return false;
  const uint32_t a = faces_[at.face][(opposite + 1) % 3], b = faces_[at.face][(opposite + 2) % 3];
  const glm::dvec3 edge = glm::normalize(glm::dvec3(positions_[b]) - glm::dvec3(positions_[a]));
  // The component across the edge points in the direction of travel in both faces.
  const glm::dvec3 out = -glm::cross(faceNormal(at.face), edge);
  const double along = glm::dot(direction, edge), across = glm::dot(direction, out);
  SurfacePoint point{static_cast<uint32_t>(next), glm::dvec3(0)};
  bool same_winding = false;
  for (int k = 0; k < 3; ++k) {
    const uint32_t vertex = faces_[point.face][k];
    if (vertex == a) point.share[k] = at.share[(opposite + 1) % 3];
    if (vertex == b) point.share[k] = at.share[(opposite + 2) % 3];
    same_winding |= vertex == a && faces_[point.face][(k + 1) % 3] == b;
  }
  const glm::dvec3 in = (same_winding ? 1.0 : -1.0) * glm::cross(faceNormal(point.face), edge);
  direction = glm::normalize(along * edge + across * in);
  at = point;
  return true;
}

SurfacePoint Surface::walk(const SurfacePoint& from, const glm::dvec3& step) const {
  SurfacePoint at = from;
  double left = glm::length(step);
  const glm::dvec3 n = faceNormal(at.face);
  glm::dvec3 direction = step - glm::dot(step, n) * n;
  if (!(left > 0) || !(glm::length(direction) > 1e-9 * left)) return at;
  direction = glm::normalize(direction);
  for (int i = 0; i < kMaxCrossings && left > 0; ++i) {
    const glm::dvec3 rate = shareRate(at.face, direction);
    int edge = -1;
    double travel = left;
    for (int k = 0; k < 3; ++k) {
      if (rate[k] >= 0 || at.share[k] > -rate[k] * travel) continue;
      travel = std::max(0.0, -at.share[k] / rate[k]);
      edge = k;
    }
    at.share = glm::max(at.share + travel * rate, glm::dvec3(0));
    at.share /= at.share.x + at.share.y + at.share.z;
    left -= travel;
    if (edge < 0) break;
    at.share[edge] = 0;
    if (!cross(at, edge, direction)) break;
  }
  return at;
}

}  // namespace fourdvt::studio

// SPDX-License-Identifier: Apache-2.0
#include "track/mesh/nearest.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::track {
namespace {

constexpr uint32_t kLeafTriangles = 4;
constexpr int kMaxDepth = 64;      // halving leaves at most 32 levels
constexpr double kNoArea = 1e-20;  // square of twice the area over the fourth power of the longest side

double squared(const glm::dvec3& v) { return glm::dot(v, v); }

double squaredDistance(const glm::dvec3& point, const glm::vec3& low, const glm::vec3& high) {
  return squared(glm::max(glm::max(glm::dvec3(low) - point, point - glm::dvec3(high)), 0.0));
}

// Share of the way from `a` to `b` at which the segment is nearest to `point`.
double nearestShare(const glm::dvec3& point, const glm::dvec3& a, const glm::dvec3& b) {
  const double length = squared(b - a);
  return length > 0 ? std::clamp(glm::dot(point - a, b - a) / length, 0.0, 1.0) : 0;
}

// Barycentric weights of the nearest point on the sides.
glm::dvec3 nearestOnSides(const glm::dvec3& point, const glm::dvec3 corners[3]) {
  glm::dvec3 best(0);
  double best_distance = INFINITY;
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3;
    const double share = nearestShare(point, corners[k], corners[l]);
    const double distance = squared(glm::mix(corners[k], corners[l], share) - point);
    if (distance >= best_distance) continue;
    best_distance = distance;
    best = glm::dvec3(0);
    best[k] = 1 - share;
    best[l] = share;
  }
  return best;
}

// Barycentric weights of the nearest point on the triangle.
glm::dvec3 nearestOnTriangle(const glm::dvec3& point, const glm::dvec3 corners[3]) {
  const glm::dvec3 ab = corners[1] - corners[0], ac = corners[2] - corners[0], ap = point - corners[0];
  const glm::dvec3 normal = glm::cross(ab, ac);
  const double area = squared(normal), longest = std::max({squared(ab), squared(ac), squared(ac - ab)});
  if (area > kNoArea * longest * longest) {
    const double v = glm::dot(glm::cross(ap, ac), normal) / area, w = glm::dot(glm::cross(ab, ap), normal) / area;
    if (v >= 0 && w >= 0 && v + w <= 1) return {1 - v - w, v, w};
  }
  return nearestOnSides(point, corners);
}

}  // namespace

NearestSurface::NearestSurface(const TriangleMesh& mesh) {
  triangles_.reserve(mesh.faces.size());
  normals_.reserve(mesh.faces.size());
  for (uint32_t f = 0; f < mesh.faces.size(); ++f) {
    const glm::uvec3& face = mesh.faces[f];
    triangles_.push_back({{mesh.positions[face.x], mesh.positions[face.y], mesh.positions[face.z]}, f});
    const auto& c = triangles_.back().corners;
    const glm::dvec3 a(c[0]), normal = glm::cross(glm::dvec3(c[1]) - a, glm::dvec3(c[2]) - a);
    const double length = glm::length(normal);
    normals_.emplace_back(length > 0 ? normal / length : glm::dvec3(0));
  }
  if (triangles_.empty()) return;
  nodes_.reserve(triangles_.size());
  nodes_.push_back({.low = {}, .high = {}, .begin = 0, .end = uint32_t(triangles_.size())});
  for (uint32_t node = 0; node < nodes_.size(); ++node) build(node);
}

// Computes the node's box and, above a leaf's size, halves its triangles along the longest side of their centres' box.
void NearestSurface::build(uint32_t node) {
  Node at = nodes_[node];
  const auto centre = [](const Triangle& t) { return t.corners[0] + t.corners[1] + t.corners[2]; };
  glm::vec3 low = centre(triangles_[at.begin]), high = low;
  at.low = at.high = triangles_[at.begin].corners[0];
  for (uint32_t i = at.begin; i < at.end; ++i) {
    low = glm::min(low, centre(triangles_[i]));
    high = glm::max(high, centre(triangles_[i]));
    for (const glm::vec3& p : triangles_[i].corners) {
      at.low = glm::min(at.low, p);
      at.high = glm::max(at.high, p);
    }
  }
  if (at.end - at.begin > kLeafTriangles) {
    const glm::vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const uint32_t middle = at.begin + (at.end - at.begin) / 2;
    std::nth_element(triangles_.begin() + at.begin, triangles_.begin() + middle, triangles_.begin() + at.end,
                     [&](const Triangle& a, const Triangle& b) {
                       const float of_a = centre(a)[axis], of_b = centre(b)[axis];
                       return of_a != of_b ? of_a < of_b : a.face < b.face;
                     });
    at.children = uint32_t(nodes_.size());
    nodes_.push_back({.low = {}, .high = {}, .begin = at.begin, .end = middle});
    nodes_.push_back({.low = {}, .high = {}, .begin = middle, .end = at.end});
  }
  nodes_[node] = at;
}

template <class Accept>
std::optional<NearestSurface::Hit> NearestSurface::search(const glm::vec3& point, float within_m,
                                                          const Accept& accept) const {
  if (nodes_.empty() || !(within_m >= 0)) return std::nullopt;
  const glm::dvec3 p(point);
  double best = double(within_m) * within_m;
  std::optional<Hit> hit;
  glm::dvec3 nearest_point(0);
  struct Open {
    uint32_t node;
    double distance;
  } open[kMaxDepth];
  int count = 0;
  open[count++] = {0, squaredDistance(p, nodes_[0].low, nodes_[0].high)};
  while (count > 0) {
    const Open top = open[--count];
    if (top.distance > best) continue;
    const Node& node = nodes_[top.node];
    if (node.children != 0) {
      const Node *first = &nodes_[node.children], *second = first + 1;
      Open near{node.children, squaredDistance(p, first->low, first->high)};
      Open far{node.children + 1, squaredDistance(p, second->low, second->high)};
      if (far.distance < near.distance) std::swap(near, far);
      if (far.distance <= best) open[count++] = far;
      if (near.distance <= best) open[count++] = near;
      continue;
    }
    for (uint32_t i = node.begin; i < node.end; ++i) {
      const Triangle& t = triangles_[i];
      if (!accept(t.face)) continue;
      const glm::dvec3 corners[3] = {glm::dvec3(t.corners[0]), glm::dvec3(t.corners[1]), glm::dvec3(t.corners[2])};
      const glm::dvec3 weights = nearestOnTriangle(p, corners);
      const glm::dvec3 on = weights.x * corners[0] + weights.y * corners[1] + weights.z * corners[2];
      const double distance = squared(on - p);
      if (distance > best || (hit && distance == best && t.face > hit->face)) continue;
      best = distance;
      nearest_point = on;
      hit = Hit{.point = {}, .face = t.face, .barycentric = glm::vec3(weights), .distance_m = 0};
    }
  }
  if (hit) {
    hit->point = glm::vec3(nearest_point);
    hit->distance_m = float(std::sqrt(best));
  }
  return hit;
}

std::optional<NearestSurface::Hit> NearestSurface::nearest(const glm::vec3& point, float within_m) const {
  return search(point, within_m, [](uint32_t) { return true; });
}

std::optional<NearestSurface::Hit> NearestSurface::nearestFacing(const glm::vec3& point, const glm::vec3& normal,
                                                                 float min_cosine, float within_m) const {
  return search(point, within_m, [&](uint32_t face) { return glm::dot(normals_[face], normal) >= min_cosine; });
}

}  // namespace fourdvt::track

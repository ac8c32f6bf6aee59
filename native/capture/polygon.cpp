// SPDX-License-Identifier: Apache-2.0
#include "capture/polygon.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "base/triangulate.h"

namespace fourdvt::capture {
namespace {

constexpr double kFlat = 1e-6;  // share of the polygon's area; smaller flipped triangles have no orientation

// Twice the area, along the mean normal, by Newell's method.
glm::dvec3 areaOf(std::span<const glm::vec3> corners) {
  glm::dvec3 twice(0);
  const glm::dvec3 origin = corners[0];
  for (size_t i = 1; i + 1 < corners.size(); ++i)
    twice += glm::cross(glm::dvec3(corners[i]) - origin, glm::dvec3(corners[i + 1]) - origin);
  return twice;
}

void addFan(size_t corners, std::vector<glm::uvec3>& triangles) {
  for (uint32_t i = 2; i < corners; ++i) triangles.emplace_back(0, i - 1, i);
}

// Returns true if no triangle is flipped.
bool facesOneWay(std::span<const glm::vec3> corners, std::span<const glm::uvec3> triangles, const glm::dvec3& area) {
  const double least = -kFlat * glm::dot(area, area);
  return std::all_of(triangles.begin(), triangles.end(), [&](const glm::uvec3& t) {
    const glm::dvec3 a = corners[t.x], b = corners[t.y], c = corners[t.z];
    return glm::dot(glm::cross(b - a, c - a), area) >= least;
  });
}

FlatLoop inPlane(std::span<const glm::vec3> corners, const glm::dvec3& area) {
  const glm::dvec3 normal = glm::normalize(area);
  const glm::dvec3 size = glm::abs(normal);
  const glm::dvec3 least = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                           : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                : glm::dvec3(0, 0, 1);
  const glm::dvec3 right = glm::normalize(glm::cross(least, normal)), up = glm::cross(normal, right);
  std::map<std::tuple<float, float, float>, uint32_t> first;  // position → corner
  FlatLoop loop;
  for (uint32_t i = 0; i < corners.size(); ++i) {
    const glm::vec3& p = corners[i];
    const glm::dvec3 offset = glm::dvec3(p) - glm::dvec3(corners[0]);
    loop.push_back(
        {{glm::dot(offset, right), glm::dot(offset, up)}, first.try_emplace({p.x, p.y, p.z}, i).first->second});
  }
  return loop;
}

}  // namespace

bool splitPolygon(std::span<const glm::vec3> corners, std::vector<glm::uvec3>& triangles) {
  std::vector<glm::uvec3> own;
  addFan(corners.size(), own);
  const glm::dvec3 area = corners.size() > 3 ? areaOf(corners) : glm::dvec3(0);
  if (std::isfinite(glm::dot(area, area)) && !facesOneWay(corners, own, area)) {
    if (corners.size() > kMaxConcaveCorners) return false;
    std::vector<glm::uvec3> clipped;
    triangulate({inPlane(corners, area)}, clipped);
    if (facesOneWay(corners, clipped, area)) own = std::move(clipped);
  }
  triangles.insert(triangles.end(), own.begin(), own.end());
  return true;
}

std::string tooManyCorners(size_t corners) {
  return "a face of " + std::to_string(corners) + " corners is not convex; triangulate the mesh before you export it";
}

void LatePolygons::add(size_t first_face, std::span<const uint32_t> corners) {
  if (corners.size() <= 3) return;
  polygons_.push_back({first_face, corners_.size(), corners.size()});
  corners_.insert(corners_.end(), corners.begin(), corners.end());
}

size_t LatePolygons::split(std::span<const glm::vec3> positions, std::vector<glm::uvec3>& faces) const {
  std::vector<glm::vec3> places;
  std::vector<glm::uvec3> triangles;
  for (const Polygon& polygon : polygons_) {
    const auto corners = std::span(corners_).subspan(polygon.first_corner, polygon.count);
    if (std::any_of(corners.begin(), corners.end(), [&](uint32_t c) { return c >= positions.size(); })) continue;
    places.clear();
    triangles.clear();
    for (const uint32_t corner : corners) places.push_back(positions[corner]);
    if (!splitPolygon(places, triangles)) return polygon.count;
    for (size_t t = 0; t < triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) faces[polygon.first_face + t][k] = corners[triangles[t][k]];
  }
  return 0;
}

}  // namespace fourdvt::capture

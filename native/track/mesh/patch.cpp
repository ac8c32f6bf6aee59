// SPDX-License-Identifier: Apache-2.0
#include "track/mesh/patch.h"

#include <algorithm>
#include <numeric>

#include "track/mesh/triangle.h"

namespace fourdvt::track {
namespace {

constexpr uint32_t kNoTextureVertex = ~uint32_t(0);

// Numbers the texture vertices: turns round each vertex's fan, from its first half-edge where the fan is open.
void numberVertices(const Surface& s, const std::vector<uint8_t>& glued, const std::vector<uint32_t>& place_of,
                    Patch& patch) {
  patch.corners.assign(patch.faces.size(), glm::uvec3(kNoTextureVertex));
  for (size_t i = 0; i < patch.faces.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      if (patch.corners[i][k] != kNoTextureVertex) continue;
      uint32_t first = 3 * patch.faces[i] + uint32_t(k);
      for (uint32_t h = first; glued[h];) {
        h = Surface::next(s.twins[h]);
        if (h == first) break;
        if (!glued[h]) first = h;
      }
      const uint32_t number = uint32_t(patch.vertices.size());
      patch.vertices.push_back(s.from(first));
      uint32_t h = first;
      for (;;) {
        patch.corners[place_of[h / 3]][int(h % 3)] = number;
        h = Surface::previous(h);
        if (!glued[h]) break;
        h = s.twins[h];
        if (h == first) break;
      }
    }
}

size_t countParts(const Surface& s, const std::vector<uint8_t>& glued, const FaceSet& faces,
                  const std::vector<uint32_t>& place_of) {
  std::vector<uint8_t> seen(faces.size(), 0);
  size_t parts = 0;
  for (size_t i = 0; i < faces.size(); ++i) {
    if (seen[i]) continue;
    ++parts;
    std::vector<uint32_t> open{faces[i]};
    seen[i] = 1;
    while (!open.empty()) {
      const uint32_t f = open.back();
      open.pop_back();
      for (uint32_t h = 3 * f; h < 3 * f + 3; ++h)
        if (const uint32_t g = s.faceAcross(h); glued[h] && !seen[place_of[g]])
          seen[place_of[g]] = 1, open.push_back(g);
    }
  }
  return parts;
}

}  // namespace

uint32_t nextOnBorder(const Surface& s, const std::vector<uint8_t>& glued, uint32_t half_edge) {
  uint32_t h = Surface::next(half_edge);
  while (glued[h]) h = Surface::next(s.twins[h]);
  return h;
}

Patch patchOf(const Surface& s, FaceSet faces, const std::vector<uint8_t>& glued) {
  Patch patch;
  patch.faces = std::move(faces);
  std::vector<uint32_t> place_of(s.faceCount(), kNoTextureVertex);
  for (uint32_t i = 0; i < patch.faces.size(); ++i) place_of[patch.faces[i]] = i;
  numberVertices(s, glued, place_of, patch);
  size_t open = 0;
  uint32_t start = kNoTextureVertex;
  for (const uint32_t f : patch.faces)
    for (uint32_t h = 3 * f; h < 3 * f + 3; ++h)
      if (!glued[h]) ++open, start = std::min(start, h);
  if (start == kNoTextureVertex) return patch;
  for (uint32_t h = start; patch.border.empty() || h != start; h = nextOnBorder(s, glued, h)) {
    patch.border.push_back(h);
    patch.border_vertices.push_back(patch.corners[place_of[h / 3]][int(h % 3)]);
  }
  const size_t edges = (3 * patch.faces.size() + open) / 2;
  patch.disk = patch.border.size() == open && patch.vertices.size() + patch.faces.size() == edges + 1 &&
               countParts(s, glued, patch.faces, place_of) == 1;
  return patch;
}

Stretch stretchOf(const Surface& s, const Patch& patch) {
  Stretch out;
  double surface_area = 0, flat_area = 0, sum = 0, largest = 0;
  for (size_t i = 0; i < patch.faces.size(); ++i) {
    const FlatTriangle triangle(s, patch.faces[i]);
    const auto [square, longest, area] = triangle.stretch(
        patch.flat[patch.corners[i].x], patch.flat[patch.corners[i].y], patch.flat[patch.corners[i].z]);
    if (!(area > 1e-9 * triangle.area())) {
      out.folded = true;
      return out;
    }
    surface_area += triangle.area();
    flat_area += area;
    sum += triangle.area() * square;
    largest = std::max(largest, longest);
  }
  const double scale = std::sqrt(flat_area / surface_area);
  out.l2 = std::sqrt(sum / surface_area) * scale;
  out.max = largest * scale;
  return out;
}

namespace {

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool crosses(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
  return turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0;
}

}  // namespace

bool borderMeetsItself(const Surface& s, const Patch& patch, double gap_m) {
  const size_t count = patch.border.size();
  const double gap2 = gap_m * gap_m;
  for (size_t i = 0; i < count; ++i) {
    const glm::dvec2 a = patch.flat[patch.border_vertices[i]], b = patch.flat[patch.border_vertices[(i + 1) % count]];
    const glm::dvec2 low = glm::min(a, b), high = glm::max(a, b);
    for (size_t j = i + 2; j < count; ++j) {
      const glm::dvec2 c = patch.flat[patch.border_vertices[j]];
      const glm::dvec2 apart = c - a;
      if (glm::dot(apart, apart) < gap2) {
        const glm::dvec3 in_space = s.points[s.from(patch.border[j])] - s.points[s.from(patch.border[i])];
        if (glm::dot(in_space, in_space) > 4 * gap2) return true;
      }
      const glm::dvec2 d = patch.flat[patch.border_vertices[(j + 1) % count]];
      if ((j + 1) % count == i || std::max(c.x, d.x) < low.x || std::min(c.x, d.x) > high.x ||
          std::max(c.y, d.y) < low.y || std::min(c.y, d.y) > high.y)
        continue;
      if (crosses(a, b, c, d)) return true;
    }
  }
  return false;
}

}  // namespace fourdvt::track

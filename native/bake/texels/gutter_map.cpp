// SPDX-License-Identifier: Apache-2.0
// Gutter map: the part of filling that depends on the UV topology only.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "bake/texels/fill.h"

namespace fourdvt::bake {
namespace {

constexpr int kMaxSteps = 64;  // maximum number of triangles that a gutter texel crosses

float cross2(glm::vec2 u, glm::vec2 v) { return u.x * v.y - u.y * v.x; }

struct EdgeOfFace {
  int face = -1, edge = 0;  // edge k joins corners k and k+1
};

// The surface in texels: its triangles, and the pairs of their edges that are one edge of the mesh.
struct Surface {
  std::vector<std::array<glm::vec2, 3>> corners;
  std::vector<std::array<EdgeOfFace, 3>> partners;  // face -1: mesh border
  std::vector<std::array<uint8_t, 3>> reversed;     // the partner's edge runs the other way

  glm::vec2 begin(EdgeOfFace e) const { return corners[e.face][e.edge]; }
  glm::vec2 end(EdgeOfFace e) const { return corners[e.face][(e.edge + 1) % 3]; }
  // Unit normal that points away from the face's third corner.
  glm::vec2 outward(EdgeOfFace e) const {
    const glm::vec2 d = glm::normalize(end(e) - begin(e));
    const glm::vec2 n(-d.y, d.x);
    return glm::dot(n, corners[e.face][(e.edge + 2) % 3] - begin(e)) > 0 ? -n : n;
  }
  EdgeOfFace partner(EdgeOfFace e) const { return partners[e.face][e.edge]; }
  // The ends of the partner edge, in the order of this edge's ends.
  std::pair<glm::vec2, glm::vec2> acrossEnds(EdgeOfFace e) const {
    const EdgeOfFace p = partner(e);
    return reversed[e.face][e.edge] ? std::pair(end(p), begin(p)) : std::pair(begin(p), end(p));
  }
  bool isSeam(EdgeOfFace e) const {
    if (partner(e).face < 0) return false;
    const auto [a, b] = acrossEnds(e);
    return a != begin(e) || b != end(e);
  }
};

// Pairs the faces at each edge. At a non-manifold edge with more than two faces, prefers a face with the same UVs, else
// the first.
void findPartners(const MeshTopology& topology, Surface& surface) {
  std::map<std::pair<uint32_t, uint32_t>, std::vector<EdgeOfFace>> by_vertices;
  const auto from = [&](EdgeOfFace e) { return topology.face_vertices[e.face][e.edge]; };
  for (int f = 0; f < int(topology.faceCount()); ++f)
    for (int k = 0; k < 3; ++k)
      by_vertices[std::minmax(topology.face_vertices[f][k], topology.face_vertices[f][(k + 1) % 3])].push_back({f, k});
  for (const auto& [vertices, edges] : by_vertices) {
    for (const EdgeOfFace& e : edges) {
      for (const EdgeOfFace& other : edges) {
        if (other.face == e.face && other.edge == e.edge) continue;
        EdgeOfFace& chosen = surface.partners[e.face][e.edge];
        if (chosen.face >= 0 && !surface.isSeam(e)) break;
        const EdgeOfFace before = chosen;
        const uint8_t before_reversed = surface.reversed[e.face][e.edge];
        chosen = other;
        surface.reversed[e.face][e.edge] = from(e) != from(other);
        if (before.face < 0 || !surface.isSeam(e)) continue;
        chosen = before;
        surface.reversed[e.face][e.edge] = before_reversed;
      }
    }
  }
}

Surface makeSurface(const MeshTopology& topology, int size) {
  Surface surface;
  for (const glm::uvec3& f : topology.face_uvs)
    surface.corners.push_back(
        {topology.uvs[f.x] * float(size), topology.uvs[f.y] * float(size), topology.uvs[f.z] * float(size)});
  surface.partners.resize(surface.corners.size());
  surface.reversed.resize(surface.corners.size());
  findPartners(topology, surface);
  return surface;
}

void rasterise(uint32_t face, GutterMap& map) {
  const std::array<glm::vec2, 3>& p = map.corners[face];
  const int size = map.size;
  const float area = cross2(p[1] - p[0], p[2] - p[0]);
  if (area == 0) return;
  const auto [x_min, x_max] = std::minmax({p[0].x, p[1].x, p[2].x});
  const auto [y_min, y_max] = std::minmax({p[0].y, p[1].y, p[2].y});
  const int x0 = std::max(0, int(std::floor(x_min - 0.5f))), x1 = std::min(size - 1, int(std::ceil(x_max - 0.5f)));
  const int y0 = std::max(0, int(std::floor(y_min - 0.5f))), y1 = std::min(size - 1, int(std::ceil(y_max - 0.5f)));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const glm::vec2 c(x + 0.5f, y + 0.5f);
      const float w0 = cross2(p[1] - p[0], c - p[0]) / area, w1 = cross2(p[2] - p[1], c - p[1]) / area,
                  w2 = cross2(p[0] - p[2], c - p[2]) / area;
      if (w0 < 0 || w1 < 0 || w2 < 0) continue;
      map.inside[static_cast<size_t>(y) * size + x] = 1;
      map.faces[static_cast<size_t>(y) * size + x] = face;
    }
  }
}

// A straight walk over the unfolded surface.
struct Walk {
  EdgeOfFace entry;  // current face, and the edge over which the walk entered it
  glm::vec2 at, rest;
};

// Crosses edge e at point `at`, with the distance `rest` remaining, both in e's chart: maps them into the partner's
// chart by the similarity that maps the edge onto its partner.
std::optional<Walk> stepAcross(const Surface& surface, EdgeOfFace e, glm::vec2 at, glm::vec2 rest) {
  const EdgeOfFace p = surface.partner(e);
  if (p.face < 0) return {};
  const glm::vec2 a = surface.begin(e), edge = surface.end(e) - a;
  const auto [a2, b2] = surface.acrossEnds(e);
  const float length = glm::length(edge), length2 = glm::length(b2 - a2);
  if (length < 1e-6f || length2 < 1e-6f) return {};
  const glm::vec2 along = edge / length, along2 = (b2 - a2) / length,
                  inward2 = -surface.outward(p) * (length2 / length);
  return Walk{p, a2 + glm::dot(at - a, along) * along2,
              glm::dot(rest, along) * along2 + glm::dot(rest, surface.outward(e)) * inward2};
}

// End of the walk; empty if the walk leaves the mesh.
std::optional<glm::vec2> walkToEnd(const Surface& surface, Walk walk) {
  for (int step = 0; step < kMaxSteps; ++step) {
    EdgeOfFace exit;
    float share = 1;  // share of `rest` up to the exit
    for (int k = 0; k < 3; ++k) {
      const EdgeOfFace e{walk.entry.face, k};
      if (k == walk.entry.edge || surface.begin(e) == surface.end(e)) continue;
      const glm::vec2 normal = surface.outward(e);
      const float speed = glm::dot(walk.rest, normal);
      if (speed <= 0) continue;
      const float s = std::max(0.0f, glm::dot(surface.begin(e) - walk.at, normal) / speed);
      if (s < share) share = s, exit = e;
    }
    if (exit.face < 0) return walk.at + walk.rest;
    const auto next = stepAcross(surface, exit, walk.at + share * walk.rest, (1 - share) * walk.rest);
    if (!next) return {};
    walk = *next;
  }
  return {};
}

struct Nearest {
  float cost = std::numeric_limits<float>::max();
  float x = 0, y = 0;  // source
};

// Assigns a chart's border edge to those empty texels around it to which no other edge is closer so far.
void offerEdge(const Surface& surface, EdgeOfFace own, float gutter, const GutterMap& map,
               std::vector<Nearest>& nearest) {
  const glm::vec2 a = surface.begin(own), b = surface.end(own);
  const float length = glm::length(b - a);
  if (length < 1e-6f) return;
  const glm::vec2 outward = surface.outward(own), along = (b - a) / length;
  const glm::vec2 low = glm::min(a, b) - gutter, high = glm::max(a, b) + gutter;
  const int x0 = std::max(0, int(low.x)), x1 = std::min(map.size - 1, int(high.x));
  const int y0 = std::max(0, int(low.y)), y1 = std::min(map.size - 1, int(high.y));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const size_t texel = static_cast<size_t>(y) * map.size + x;
      if (map.inside[texel]) continue;
      const glm::vec2 offset = glm::vec2(x + 0.5f, y + 0.5f) - a;
      const float t = glm::dot(offset, along), out = glm::dot(offset, outward);
      const float beyond = std::max({0.0f, -t, t - length});
      const float distance = std::hypot(out, beyond);
      if (out < -0.5f || distance > gutter) continue;
      const float cost =
          distance + 0.01f * beyond;  // at a corner of two edges, prefers the edge that the texel lies beside
      if (cost >= nearest[texel].cost) continue;
      const float on_edge = std::clamp(t, 0.0f, length);
      const auto walk =
          stepAcross(surface, own, a + on_edge * along, (t - on_edge) * along + std::max(out, 0.0f) * outward);
      const auto source = walk ? walkToEnd(surface, *walk) : std::nullopt;
      if (source) nearest[texel] = {cost, source->x, source->y};
    }
  }
}

}  // namespace

GutterMap makeGutterMap(const MeshTopology& topology, int size, float gutter_texels) {
  GutterMap map;
  map.size = size;
  map.inside.assign(static_cast<size_t>(size) * size, 0);
  const Surface surface = makeSurface(topology, size);
  map.faces.assign(map.inside.size(), 0);
  map.corners = surface.corners;
  map.vertices = topology.face_vertices;
  map.vertex_count = topology.vertex_count;
  for (const glm::uvec3& v : map.vertices)
    for (int k = 0; k < 3; ++k) map.edges.push_back(std::minmax(v[k], v[(k + 1) % 3]));
  std::sort(map.edges.begin(), map.edges.end());
  map.edges.erase(std::unique(map.edges.begin(), map.edges.end()), map.edges.end());
  for (uint32_t f = 0; f < topology.faceCount(); ++f) rasterise(f, map);
  std::vector<Nearest> nearest(map.inside.size());
  for (int f = 0; f < int(surface.corners.size()); ++f)
    for (int k = 0; k < 3; ++k)
      if (surface.isSeam({f, k})) offerEdge(surface, {f, k}, gutter_texels, map, nearest);
  for (size_t i = 0; i < nearest.size(); ++i)
    if (nearest[i].cost < std::numeric_limits<float>::max())
      map.texels.push_back({static_cast<uint32_t>(i), nearest[i].x, nearest[i].y});
  return map;
}

}  // namespace fourdvt::bake

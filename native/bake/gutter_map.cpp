// SPDX-License-Identifier: Apache-2.0
// The static half of the fill stage.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "bake/fill.h"

namespace fourdvt::bake {
namespace {

struct UvEdge {
  uint32_t vertex_a, vertex_b;  // vertex_a < vertex_b
  glm::vec2 a, b, opposite;     // texels; opposite: the face's third corner
};

float cross2(glm::vec2 u, glm::vec2 v) { return u.x * v.y - u.y * v.x; }

std::vector<UvEdge> allEdges(const MeshTopology& topology, int size) {
  std::vector<UvEdge> edges;
  edges.reserve(3 * topology.faceCount());
  for (uint32_t f = 0; f < topology.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3, third = (k + 2) % 3;
      UvEdge edge{topology.face_vertices[f][k], topology.face_vertices[f][next],
                  topology.uvs[topology.face_uvs[f][k]] * float(size),
                  topology.uvs[topology.face_uvs[f][next]] * float(size),
                  topology.uvs[topology.face_uvs[f][third]] * float(size)};
      if (edge.vertex_a > edge.vertex_b) {
        std::swap(edge.vertex_a, edge.vertex_b);
        std::swap(edge.a, edge.b);
      }
      edges.push_back(edge);
    }
  }
  return edges;
}

bool sameUvs(const UvEdge& p, const UvEdge& q) { return p.a == q.a && p.b == q.b; }

// Border edges of charts, each with the partner edge in the neighbouring chart.
std::vector<std::pair<UvEdge, UvEdge>> seamEdges(const MeshTopology& topology, int size) {
  std::map<std::pair<uint32_t, uint32_t>, std::vector<UvEdge>> by_vertices;
  for (const UvEdge& edge : allEdges(topology, size)) by_vertices[{edge.vertex_a, edge.vertex_b}].push_back(edge);
  std::vector<std::pair<UvEdge, UvEdge>> seams;
  for (const auto& [key, edges] : by_vertices) {
    for (size_t i = 0; i < edges.size(); ++i) {
      const UvEdge* partner = nullptr;
      bool inner = false;
      for (size_t j = 0; j < edges.size(); ++j) {
        if (j == i) continue;
        if (sameUvs(edges[i], edges[j]))
          inner = true;
        else if (!partner)
          partner = &edges[j];
      }
      if (!inner && partner) seams.push_back({edges[i], *partner});
    }
  }
  return seams;
}

void rasterise(const glm::vec2 (&p)[3], int size, std::vector<uint8_t>& inside) {
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
      if (w0 >= 0 && w1 >= 0 && w2 >= 0) inside[static_cast<size_t>(y) * size + x] = 1;
    }
  }
}

struct Nearest {
  float cost = std::numeric_limits<float>::max();
  float x = 0, y = 0;  // source
};

// Unit normal of the edge that points away from the face's third corner.
glm::vec2 outwardNormal(const UvEdge& e) {
  const glm::vec2 d = glm::normalize(e.b - e.a);
  const glm::vec2 n(-d.y, d.x);
  return glm::dot(n, e.opposite - e.a) > 0 ? -n : n;
}

// Offers edge `own` as the nearest border to the empty texels round it: t along the edge and the distance outwards go
// to the same t along the partner and that distance inwards, scaled by the ratio of the lengths.
void stepAcross(const UvEdge& own, const UvEdge& partner, float gutter, const GutterMap& map,
                std::vector<Nearest>& nearest) {
  const float length = glm::length(own.b - own.a), partner_length = glm::length(partner.b - partner.a);
  if (length < 1e-6f || partner_length < 1e-6f) return;
  const glm::vec2 outward = outwardNormal(own), along = (own.b - own.a) / length;
  const glm::vec2 inward = -outwardNormal(partner) * (partner_length / length);
  const glm::vec2 low = glm::min(own.a, own.b) - gutter, high = glm::max(own.a, own.b) + gutter;
  const int x0 = std::max(0, int(low.x)), x1 = std::min(map.size - 1, int(high.x));
  const int y0 = std::max(0, int(low.y)), y1 = std::min(map.size - 1, int(high.y));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const size_t texel = static_cast<size_t>(y) * map.size + x;
      if (map.inside[texel]) continue;
      const glm::vec2 offset = glm::vec2(x + 0.5f, y + 0.5f) - own.a;
      const float t = glm::dot(offset, along), out = glm::dot(offset, outward);
      const float beyond = std::max({0.0f, -t, t - length});
      const float distance = std::hypot(out, beyond);
      if (out < -0.5f || distance > gutter) continue;
      const float cost = distance + 0.01f * beyond;  // of two edges that meet in a corner: the one it lies beside
      if (cost >= nearest[texel].cost) continue;
      const glm::vec2 source = partner.a + (t / length) * (partner.b - partner.a) + std::max(out, 0.0f) * inward;
      nearest[texel] = {cost, source.x, source.y};
    }
  }
}

bool insideAt(const GutterMap& map, float x, float y) {
  const int ix = int(std::floor(x)), iy = int(std::floor(y));
  return ix >= 0 && iy >= 0 && ix < map.size && iy < map.size && map.inside[static_cast<size_t>(iy) * map.size + ix];
}

}  // namespace

GutterMap makeGutterMap(const MeshTopology& topology, int size, float gutter_texels) {
  GutterMap map;
  map.size = size;
  map.inside.assign(static_cast<size_t>(size) * size, 0);
  for (const glm::uvec3& f : topology.face_uvs) {
    const glm::vec2 corners[3] = {topology.uvs[f.x] * float(size), topology.uvs[f.y] * float(size),
                                  topology.uvs[f.z] * float(size)};
    rasterise(corners, size, map.inside);
  }
  std::vector<Nearest> nearest(map.inside.size());
  for (const auto& [own, partner] : seamEdges(topology, size)) stepAcross(own, partner, gutter_texels, map, nearest);
  for (size_t i = 0; i < nearest.size(); ++i) {
    const Nearest& n = nearest[i];
    if (n.cost < std::numeric_limits<float>::max() && insideAt(map, n.x, n.y))
      map.texels.push_back({static_cast<uint32_t>(i), n.x, n.y});
  }
  return map;
}

}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
#include "package/chunk_mesh.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::package {
namespace {

constexpr size_t kMaxEarlier = 24;

struct Edge {
  uint32_t a, b, face, corner;  // a <= b
  bool operator<(const Edge& o) const {
    if (a != o.a) return a < o.a;
    if (b != o.b) return b < o.b;
    return face != o.face ? face < o.face : corner < o.corner;
  }
};

std::vector<Edge> sortedEdges(const std::vector<glm::uvec3>& faces) {
  std::vector<Edge> edges;
  edges.reserve(faces.size() * 3);
  for (uint32_t f = 0; f < faces.size(); ++f) {
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t a = faces[f][k], b = faces[f][(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), f, k});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// Links faces that share an edge in pairs: first with second, third with fourth.
void linkFaces(const std::vector<Edge>& edges, ChunkMesh& out) {
  for (size_t i = 0; i + 1 < edges.size();) {
    const Edge &e = edges[i], &o = edges[i + 1];
    if (e.a != o.a || e.b != o.b) {
      ++i;
      continue;
    }
    out.face_neighbours[e.face][e.corner] = o.face;
    out.face_neighbours[o.face][o.corner] = e.face;
    i += 2;
  }
}

struct Adjacency {
  std::vector<uint32_t> first, neighbours;  // ascending within a vertex
  std::span<const uint32_t> of(uint32_t v) const {
    return std::span(neighbours).subspan(first[v], first[v + 1] - first[v]);
  }
};

Adjacency vertexAdjacency(const std::vector<Edge>& edges, uint32_t vertex_count) {
  const auto eachEdge = [&](auto&& visit) {
    for (size_t i = 0; i < edges.size(); ++i) {
      const bool repeated = i > 0 && edges[i].a == edges[i - 1].a && edges[i].b == edges[i - 1].b;
      if (!repeated && edges[i].a != edges[i].b) visit(edges[i].a, edges[i].b);
    }
  };
  Adjacency out{std::vector<uint32_t>(vertex_count + 1), {}};
  eachEdge([&](uint32_t a, uint32_t b) { ++out.first[a + 1], ++out.first[b + 1]; });
  for (uint32_t v = 0; v < vertex_count; ++v) out.first[v + 1] += out.first[v];
  out.neighbours.resize(out.first.back());
  std::vector<uint32_t> next(out.first.begin(), out.first.end() - 1);
  eachEdge([&](uint32_t a, uint32_t b) { out.neighbours[next[b]++] = a; });  // smaller indices first
  eachEdge([&](uint32_t a, uint32_t b) { out.neighbours[next[a]++] = b; });
  return out;
}

// Lists neighbours below v ascending; then for each of them in turn its neighbours below v, descending.
void listEarlier(const Adjacency& adjacency, uint32_t v, ChunkMesh& out) {
  const auto own = adjacency.of(v);
  std::vector<uint32_t> list(own.begin(), std::lower_bound(own.begin(), own.end(), v));
  if (list.size() > kMaxEarlier) list.resize(kMaxEarlier);
  out.ring_count.push_back(static_cast<uint8_t>(list.size()));
  const size_t ring = list.size();
  for (size_t i = 0; i < ring; ++i) {
    const auto next = adjacency.of(list[i]);
    auto it = std::lower_bound(next.begin(), next.end(), v);
    while (it != next.begin() && list.size() < kMaxEarlier) {
      --it;
      if (std::find(list.begin(), list.end(), *it) == list.end()) list.push_back(*it);
    }
  }
  out.earlier.insert(out.earlier.end(), list.begin(), list.end());
  out.earlier_first.push_back(static_cast<uint32_t>(out.earlier.size()));
}

// Recovers Draco's integers from the decoded positions: the same start on every machine.
std::vector<glm::ivec3> lattice(const Positions& positions) {
  glm::dvec3 low(positions.empty() ? glm::vec3(0) : positions[0]), high = low;
  for (const glm::vec3& p : positions) low = glm::min(low, glm::dvec3(p)), high = glm::max(high, glm::dvec3(p));
  const glm::dvec3 size = high - low;
  const double longest = std::max(size.x, std::max(size.y, size.z));
  std::vector<glm::ivec3> out(positions.size(), glm::ivec3(0));
  if (!(longest > 0)) return out;
  for (size_t v = 0; v < positions.size(); ++v) {
    for (int k = 0; k < 3; ++k) {
      out[v][k] = static_cast<int>(std::floor((double(positions[v][k]) - low[k]) / longest * 16383 + 0.5));
    }
  }
  return out;
}

}  // namespace

ChunkMesh makeChunkMesh(const BaseMesh& mesh) {
  return makeChunkMesh(mesh.topology.face_vertices, lattice(mesh.positions));
}

ChunkMesh makeChunkMesh(const std::vector<glm::uvec3>& faces, std::vector<glm::ivec3> base) {
  ChunkMesh out;
  out.face_neighbours.assign(faces.size(), {kNoFace, kNoFace, kNoFace});
  out.base = std::move(base);
  const std::vector<Edge> edges = sortedEdges(faces);
  linkFaces(edges, out);
  const Adjacency adjacency = vertexAdjacency(edges, out.vertexCount());
  out.earlier_first.push_back(0);
  for (uint32_t v = 0; v < out.vertexCount(); ++v) listEarlier(adjacency, v, out);
  return out;
}

}  // namespace fourdvt::package

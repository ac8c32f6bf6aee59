// SPDX-License-Identifier: Apache-2.0
#include "package/chunk_mesh.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::package {
namespace {

constexpr size_t kMaxEarlier = 10;

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

// Takes vertices in rounds, coarse to fine: the round of radius r takes each vertex, ascending, that is at least r
// edges away from all that are taken. Lists for each the taken ones around it.
class CoarseToFine {
 public:
  CoarseToFine(const Adjacency& adjacency, ChunkMesh& out)
      : adjacency_(adjacency),
        out_(out),
        count_(out.vertexCount()),
        distance_(count_, kRadii[0]),
        seen_(count_, count_) {}

  void run() {
    out_.ring_count.resize(count_);
    out_.last_round.resize(count_);
    std::vector<uint32_t> first, lists;  // in the order of `order`
    for (uint32_t radius : kRadii) {
      for (uint32_t v = 0; v < count_; ++v) {
        if (distance_[v] < radius) continue;
        first.push_back(static_cast<uint32_t>(lists.size()));
        listTaken(v, radius, lists);
        take(v, radius);
      }
    }
    first.push_back(static_cast<uint32_t>(lists.size()));
    sortByVertex(first, lists);
  }

 private:
  static constexpr uint32_t kRadii[] = {32, 16, 8, 4, 2, 1};
  struct Visit {
    uint32_t vertex, edges;
  };

  // Appends the first taken vertices of a breadth-first search from v.
  void listTaken(uint32_t v, uint32_t radius, std::vector<uint32_t>& lists) {
    const size_t start = lists.size(), max_visits = 1 + 64 + 16 * radius * radius;
    uint32_t nearest = 0;
    visits_.assign(1, {v, 0});
    seen_[v] = v;
    for (size_t i = 0; i < visits_.size(); ++i) {
      const auto [at, edges] = visits_[i];
      if (i > 0 && distance_[at] == 0) {
        if (lists.size() == start) nearest = edges;
        out_.ring_count[v] += edges == nearest;
        lists.push_back(at);
        if (lists.size() - start == kMaxEarlier) return;
      }
      if (edges == 2 * radius) continue;
      for (uint32_t u : adjacency_.of(at)) {
        if (visits_.size() == max_visits) break;
        if (seen_[u] == v) continue;
        seen_[u] = v;
        visits_.push_back({u, edges + 1});
      }
    }
  }

  void take(uint32_t v, uint32_t radius) {
    out_.order.push_back(v);
    out_.last_round[v] = radius == 1;
    distance_[v] = 0;
    visits_.assign(1, {v, 0});
    for (size_t i = 0; i < visits_.size(); ++i) {
      const auto [at, edges] = visits_[i];
      if (edges + 1 == radius) break;
      for (uint32_t u : adjacency_.of(at)) {
        if (distance_[u] <= edges + 1) continue;
        distance_[u] = edges + 1;
        visits_.push_back({u, edges + 1});
      }
    }
  }

  // first: start of each list, in the order of `order`, and the end.
  void sortByVertex(const std::vector<uint32_t>& first, const std::vector<uint32_t>& lists) {
    std::vector<uint32_t> place(count_);
    for (uint32_t i = 0; i < count_; ++i) place[out_.order[i]] = i;
    out_.earlier_first.push_back(0);
    for (uint32_t i : place) {
      out_.earlier.insert(out_.earlier.end(), lists.begin() + first[i], lists.begin() + first[i + 1]);
      out_.earlier_first.push_back(static_cast<uint32_t>(out_.earlier.size()));
    }
  }

  const Adjacency& adjacency_;
  ChunkMesh& out_;
  const uint32_t count_;
  std::vector<uint32_t> distance_;  // [vertex] edges to the nearest taken vertex, exact below the round's radius
  std::vector<uint32_t> seen_;      // [vertex] latest search that reached it, by its start
  std::vector<Visit> visits_;
};

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
  CoarseToFine(adjacency, out).run();
  return out;
}

}  // namespace fourdvt::package

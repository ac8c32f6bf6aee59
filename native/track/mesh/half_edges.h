// SPDX-License-Identifier: Apache-2.0
// Closed triangle mesh by half-edges, with the three changes that remeshing makes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::track {

// Topology only. Half-edge 3 f + k runs from corner k of face f to the next corner. Removed faces and vertices keep
// their numbers, which are not used again.
class HalfEdges {
 public:
  static constexpr uint32_t kNone = 0xffffffff;

  // Requires valid indices. Appends to `positions` a copy of a vertex for each further fan of faces round it, so that
  // parts that touch in a vertex come apart. MeshTopology: an edge without exactly two faces of opposite direction.
  static Result<HalfEdges> of(const std::vector<glm::uvec3>& faces, Positions& positions);

  uint32_t vertexCount() const { return uint32_t(outgoing_.size()); }  // removed ones included
  uint32_t halfEdgeCount() const { return uint32_t(from_.size()); }    // removed ones included
  size_t faceCount() const { return faces_; }                          // without removed ones

  bool hasVertex(uint32_t v) const { return outgoing_[v] != kNone; }
  bool hasHalfEdge(uint32_t h) const { return from_[h] != kNone; }
  static uint32_t next(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static uint32_t previous(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  uint32_t from(uint32_t h) const { return from_[h]; }
  uint32_t to(uint32_t h) const { return from_[next(h)]; }
  uint32_t opposite(uint32_t h) const { return from_[previous(h)]; }  // the face's third vertex
  uint32_t twin(uint32_t h) const { return twin_[h]; }

  // Calls visit(h) for each half-edge from `v`; h's face is (v, to(h), opposite(h)).
  template <class Visit>
  void around(uint32_t v, const Visit& visit) const {
    const uint32_t first = outgoing_[v];
    uint32_t h = first;
    do {
      visit(h);
      h = twin_[previous(h)];
    } while (h != first);
  }

  int valence(uint32_t v) const;
  bool adjacent(uint32_t a, uint32_t b) const;

  // Returns true where the mesh stays a manifold of the same topology; collapse: the link condition.
  bool mayCollapse(uint32_t h) const;
  bool mayFlip(uint32_t h) const;

  void collapse(uint32_t h);   // merges to(h) into from(h); requires mayCollapse
  void flip(uint32_t h);       // requires mayFlip
  uint32_t split(uint32_t h);  // returns the new vertex in the edge

  std::vector<glm::uvec3> faces() const;

 private:
  void join(uint32_t a, uint32_t b) {
    twin_[a] = b;
    twin_[b] = a;
  }
  Status pair();
  void separateFans(Positions& positions);

  std::vector<uint32_t> from_, twin_;  // [half-edge]
  std::vector<uint32_t> outgoing_;     // [vertex] any half-edge from it; kNone: removed or never used
  size_t faces_ = 0;
};

}  // namespace fourdvt::track

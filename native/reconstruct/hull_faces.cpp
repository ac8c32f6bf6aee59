// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/hull_faces.h"

#include <cmath>
#include <string>
#include <unordered_map>
#include <utility>

#include "base/triangulate.h"

namespace fourdvt::reconstruct {
namespace {

constexpr uint32_t kNoPlace = ~0u;

struct NameHash {
  size_t operator()(VertexName name) const { return size_t((name ^ (name >> 31)) * 0x9E3779B97F4A7C15ull >> 7); }
};

class FaceLinker {
 public:
  FaceLinker(const HullPlanes& planes, std::vector<HalfEdge>& edges) : planes_(planes), edges_(edges) {}

  Result<TriangleMesh> run() {
    nameVertices();
    for (int count : edges_at_)
      if (count != 6) return open("a vertex has " + std::to_string(count) + " half edges in place of 6");
    std::stable_sort(edges_.begin(), edges_.end(),
                     [](const HalfEdge& a, const HalfEdge& b) { return a.plane < b.plane; });
    next_.assign(places_.size(), kNoPlace);
    for (size_t begin = 0, end = 0; begin < edges_.size(); begin = end) {
      while (end < edges_.size() && edges_[end].plane == edges_[begin].plane) ++end;
      FOURDVT_TRY(addFaces(std::span(edges_).subspan(begin, end - begin)));
    }
    for (const glm::dvec3& place : places_) mesh_.positions.emplace_back(planes_.inWorld(place));
    return std::move(mesh_);
  }

 private:
  static Error open(const std::string& what) {
    return {ErrorId::Internal, "polyhedral hull: the surface does not close: " + what};
  }

  void nameVertices() {
    numbers_.reserve(edges_.size() / 2);
    for (const HalfEdge& edge : edges_)
      for (VertexName name : {edge.from, edge.to}) {
        const auto [entry, added] = numbers_.try_emplace(name, uint32_t(places_.size()));
        if (added) {
          places_.push_back(placeOf(name));
          edges_at_.push_back(0);
        }
        ++edges_at_[entry->second];
      }
  }

  glm::dvec3 placeOf(VertexName name) const {
    const auto [a, b, c] = planesOf(name);
    const auto& p = planes_.planes;
    return PlanePoint(PlaneLine(p[a].plane, p[b].plane), p[c].plane).position();
  }

  // The loops of one plane, triangulated.
  Status addFaces(std::span<const HalfEdge> edges) {
    const glm::dvec3 normal = planes_.planes[edges[0].plane].normal;
    const glm::dvec3 axis = std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 across = glm::normalize(glm::cross(axis, normal)), up = glm::cross(normal, across);
    for (const HalfEdge& edge : edges) {
      uint32_t& next = next_[numbers_.at(edge.from)];
      if (next != kNoPlace) return open("two edges of a face leave a vertex");
      next = numbers_.at(edge.to);
    }
    std::vector<FlatLoop> loops;
    for (const HalfEdge& edge : edges) {
      const uint32_t first = numbers_.at(edge.from);
      if (next_[first] == kNoPlace) continue;  // in a loop already
      FlatLoop loop;
      uint32_t at = first;
      do {
        loop.push_back({{glm::dot(places_[at], across), glm::dot(places_[at], up)}, at});
        at = std::exchange(next_[at], kNoPlace);
      } while (at != first && at != kNoPlace);
      if (at == kNoPlace || loop.size() < 3) return open("edges of a face make no loop");
      loops.push_back(std::move(loop));
    }
    triangulate(std::move(loops), mesh_.faces);
    return {};
  }

  const HullPlanes& planes_;
  std::vector<HalfEdge>& edges_;
  std::unordered_map<VertexName, uint32_t, NameHash> numbers_;
  std::vector<glm::dvec3> places_;  // per vertex, scaled
  std::vector<int> edges_at_;       // per vertex: half edges that begin or end there
  std::vector<uint32_t> next_;      // per vertex: the next one on the face at hand
  TriangleMesh mesh_;
};

}  // namespace

Result<TriangleMesh> hullFaces(const HullPlanes& planes, std::vector<HalfEdge>& edges) {
  return FaceLinker(planes, edges).run();
}

}  // namespace fourdvt::reconstruct

// SPDX-License-Identifier: Apache-2.0
// Codes a base mesh, for encoder and decoder: faces (mesh_walk.h), then indices of vertices and UVs in Draco's order,
// then their values. Predictions use IEEE double operations in the order written: files that include this must not
// contract them (-ffp-contract=off). Exact definition: FORMAT.md, "The mesh in the start file". Internal to package/.
#pragma once

#include <cmath>
#include <cstring>

#include "package/mesh_walk.h"
#include "package/residual_model.h"

namespace fourdvt::package {

// value = min + step * q in float; step 0: the values are floats.
struct MeshGrid {
  float min[3] = {}, step = 0;
};

struct MeshHeader {
  uint32_t vertex_count, uv_count, face_count;
  MeshGrid positions, uvs;
};

// Lists vertices in the order of a depth-first traversal, which is Draco's order of attribute values.
inline std::vector<uint32_t> depthFirst(const MeshLinks& m) {
  std::vector<uint32_t> order, stack;
  std::vector<uint8_t> met(m.vertex_count), border(m.vertex_count), done(m.vertex.size() / 3);
  for (uint32_t h = 0; h < m.vertex.size(); ++h) {
    if (m.across[h] == kNone) border[m.vertex[h]] = border[m.vertex[nextCorner(h)]] = true;
  }
  const auto meet = [&](uint32_t c) {
    const uint32_t v = m.vertex[c];
    if (met[v]) return false;
    met[v] = true;
    order.push_back(v);
    return !border[v];
  };
  const auto isDone = [&](uint32_t c) { return c == kNone || done[c / 3]; };
  for (uint32_t f = 0; f < done.size(); ++f) {
    for (stack.push_back(3 * f); !stack.empty();) {
      uint32_t c = stack.back();
      stack.pop_back();
      while (!isDone(c)) {
        done[c / 3] = true;
        bool inside = false;
        for (uint32_t corner : {nextCorner(c), previousCorner(c), c}) inside = meet(corner);
        const uint32_t right = m.oppositeCorner(nextCorner(c));
        if (!inside) stack.push_back(m.oppositeCorner(previousCorner(c)));
        c = right;
      }
    }
  }
  return order;
}

// Corners of each item, ascending.
struct CornersOf {
  std::vector<uint32_t> first, list;
  CornersOf(const std::vector<uint32_t>& item, uint32_t count) : first(size_t(count) + 1), list(item.size()) {
    for (uint32_t i : item) ++first[i + 1];
    for (uint32_t i = 0; i < count; ++i) first[i + 1] += first[i];
    std::vector<uint32_t> next(first.begin(), first.end() - 1);
    for (uint32_t c = 0; c < item.size(); ++c) list[next[item[c]]++] = c;
  }
  std::span<const uint32_t> of(uint32_t i) const { return std::span(list).subspan(first[i], first[i + 1] - first[i]); }
};

// Replaces the corners' items by their ranks in `order`.
inline void rank(std::vector<uint32_t>& item, const std::vector<uint32_t>& order) {
  std::vector<uint32_t> ranks(order.size());
  for (uint32_t i = 0; i < order.size(); ++i) ranks[order[i]] = i;
  for (uint32_t& i : item) i = ranks[i];
}

// Codes the mesh index of every item (vertex or UV).
template <class Symbols>
class MeshPlaces {
 public:
  // known: [item], encoder only.
  MeshPlaces(Symbols& symbols, uint32_t count, const std::vector<uint32_t>& known)
      : symbols_(symbols), known_(known), places_(count, kNone), used_(count) {}
  // Codes items begin to end - 1, and their order; mostly a single item. False: damaged bytes.
  bool group(uint32_t begin, uint32_t end) {
    rest_.clear();
    for (uint32_t i = begin; i < end; ++i) rest_.push_back(i);
    for (uint32_t at = 0; at < rest_.size(); ++at) {
      const uint32_t last = std::min<uint32_t>(at + kMaxChoice, rest_.size()) - 1;
      uint32_t i = at;
      while (i < last && !symbols_.bit(kFirstOfVertex, isFirst(i, at, last))) ++i;
      const uint32_t chosen = rest_[i];
      for (; i > at; --i) rest_[i] = rest_[i - 1];
      if (!place(chosen)) return false;
    }
    return true;
  }
  // Assigns the remaining indices to items without a face.
  std::vector<uint32_t> take() {
    uint32_t next = 0;
    for (uint32_t& p : places_) {
      if (p != kNone) continue;
      while (used_[next]) ++next;
      p = next++;
    }
    return std::move(places_);
  }

 private:
  static constexpr uint32_t kMaxChoice = 8;
  uint32_t known(uint32_t item) const { return known_.empty() ? 0 : known_[item]; }
  bool isFirst(uint32_t i, uint32_t at, uint32_t last) const {
    while (at <= last && known(rest_[i]) <= known(rest_[at])) ++at;
    return at > last;
  }
  bool place(uint32_t item) {
    const uint32_t at = symbols_.bit(kInOrder, known(item) == next_) ? next_ : symbols_.number(kPlace, known(item));
    if (at >= used_.size() || used_[at]) return false;
    used_[at] = true;
    places_[item] = at;
    next_ = at + 1;
    return true;
  }
  Symbols& symbols_;
  const std::vector<uint32_t>& known_;
  std::vector<uint32_t> places_, rest_;
  std::vector<uint8_t> used_;
  uint32_t next_ = 0;
};

// Sum of predictions of one value.
struct MeshPrediction {
  glm::dvec3 sum{0};
  double count = 0;
  void add(const glm::dvec3& p, double weight = 1) { sum = sum + p, count = count + weight; }
  glm::ivec3 rounded() const {
    const glm::dvec3 mean = sum / (count > 0 ? count : 1);
    glm::ivec3 out;
    for (int k = 0; k < 3; ++k) {
      const double limit = kMaxQuantised, r = std::floor(mean[k] + 0.5);
      out[k] = static_cast<int>(r > limit ? limit : r > -limit ? r : -limit);
    }
    return out;
  }
};

// Lists for ResidualModel the preceding items at the corners of each item's faces, with repetitions.
inline ChunkMesh earlierItems(const std::vector<uint32_t>& item, const CornersOf& corners, uint32_t count) {
  constexpr size_t kMaxEarlier = 24;
  ChunkMesh out;
  out.base.resize(count);
  out.ring_count.resize(count);
  out.earlier_first.resize(size_t(count) + 1);
  out.earlier.resize(2 * item.size());
  uint32_t end = 0;
  for (uint32_t i = 0; i < count; ++i) {
    for (uint32_t c : corners.of(i)) {
      for (uint32_t at : {nextCorner(c), previousCorner(c)}) {
        if (item[at] < i && out.ring_count[i] < kMaxEarlier) out.earlier[end++] = item[at], ++out.ring_count[i];
      }
    }
    out.earlier_first[i + 1] = end;
  }
  return out;
}

inline double dot(const glm::dvec3& a, const glm::dvec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Predicts the values of items from preceding items, triangle corner by triangle corner.
class MeshPredictor {
 public:
  // mesh: null predicts positions; else UVs, from its positions.
  MeshPredictor(const MeshLinks& links, const std::vector<uint32_t>& item, const BaseMesh* mesh,
                const std::vector<glm::ivec3>& q)
      : links_(links), item_(item), mesh_(mesh), q_(q) {}

  glm::ivec3 predict(uint32_t i, std::span<const uint32_t> corners) {
    MeshPrediction best, near;
    for (uint32_t c : corners) {
      const uint32_t a = item_[nextCorner(c)], b = item_[previousCorner(c)];
      if (a < i) near.add(value(a));
      if (b < i) near.add(value(b));
      if (a < i && b < i) addTriangle(c, best);
    }
    if (near.count == 0 && i > 0) near.add(value(i - 1));
    return (best.count > 0 ? best : near).rounded();
  }

 private:
  glm::dvec3 value(uint32_t i) const { return glm::dvec3(q_[i]); }
  glm::dvec3 position(uint32_t c) const {
    return glm::dvec3(mesh_->positions[mesh_->topology.face_vertices[c / 3][c % 3]]);
  }

  void addTriangle(uint32_t c, MeshPrediction& out) {
    const uint32_t ca = nextCorner(c), cb = previousCorner(c), o = links_.oppositeCorner(c);
    const bool opposite =
        o != kNone && item_[nextCorner(o)] == item_[cb] && item_[previousCorner(o)] == item_[ca] && item_[o] < item_[c];
    const glm::dvec3 a = value(item_[ca]), b = value(item_[cb]), other = opposite ? value(item_[o]) : a;
    if (mesh_)
      addLikeInSpace(c, a, b - a, other - a, out);
    else if (opposite)
      out.add(15.0 * (a + b) - 14.0 * other, 16);  // parallelogram, slightly flattened
  }

  // Adds the UV of corner `c` at which its triangle has the same shape as in space; the UV edge is a to a + d, and
  // `other` lies across it.
  void addLikeInSpace(uint32_t c, const glm::dvec3& a, const glm::dvec3& d, const glm::dvec3& other,
                      MeshPrediction& out) {
    const glm::dvec3 from = position(nextCorner(c)), edge = position(previousCorner(c)) - from,
                     tip = position(c) - from;
    const double length = dot(edge, edge), along = dot(tip, edge), across = dot(tip, tip) * length - along * along;
    if (!(length > 0)) return;
    const double area = d.y * other.x - d.x * other.y;
    if (area != 0) side_ = area > 0 ? 1 : -1;
    const double s = along / length, h = side_ * (std::sqrt(across > 0 ? across : 0) / length);
    out.add({a.x + s * d.x - h * d.y, a.y + s * d.y + h * d.x, 0});
  }

  const MeshLinks& links_;
  const std::vector<uint32_t>& item_;
  const BaseMesh* mesh_;
  const std::vector<glm::ivec3>& q_;
  double side_ = 1;  // 1: positive UV area in corner order
};

// Codes q of all items, ascending.
template <class Coder>
bool codeQuantised(Coder& coder, const MeshLinks& links, const BaseMesh* mesh, std::vector<glm::ivec3>& q) {
  const std::vector<uint32_t>& item = mesh ? links.uv : links.vertex;
  const uint32_t count = static_cast<uint32_t>(q.size());
  const CornersOf corners(item, count);
  const ChunkMesh ring = earlierItems(item, corners, count);
  ResidualModel<Coder> residuals(coder, ring, mesh ? 2 : 3);
  MeshPredictor predictor(links, item, mesh, q);
  for (uint32_t i = 0; i < count; ++i) {
    const glm::ivec3 p = predictor.predict(i, corners.of(i));
    q[i] = p + residuals.code(i, q[i] - p);
    if (!inRange(q[i])) return false;
  }
  return true;
}

// Mesh with a header's counts, and its quantised values by vertex and UV: encoder input, decoder result.
struct MeshContents {
  BaseMesh mesh;
  std::vector<glm::ivec3> position_q, uv_q;  // encoder only

  explicit MeshContents(const MeshHeader& h) {
    mesh.topology = {h.vertex_count, std::vector<glm::vec2>(h.uv_count), std::vector<glm::uvec3>(h.face_count), {}};
    mesh.topology.face_uvs = mesh.topology.face_vertices;
    mesh.positions.resize(h.vertex_count);
  }
};

template <class Coder, class Known>
class MeshModel {
 public:
  MeshModel(Coder& coder, Known& known, const MeshHeader& header, MeshContents& contents)
      : coder_(coder),
        symbols_(coder),
        known_(known),
        header_(header),
        contents_(contents),
        links_(header.face_count) {}

  // False: damaged bytes.
  bool code() { return codeFaces() && codeVertexPlaces() && codeUvPlaces() && codeValues(); }

 private:
  bool codeFaces() {
    MeshWalk<Coder, Known> walk(symbols_, known_, links_, header_.vertex_count, header_.uv_count);
    for (uint32_t f = header_.face_count; f-- > 0;) {
      if (!walk.face(f) || known_.lost()) return false;
    }
    return true;
  }

  bool codeVertexPlaces() {
    rank(links_.vertex, depthFirst(links_));
    auto& faces = contents_.mesh.topology.face_vertices;
    const auto known = known_.places(links_.vertex, faces, header_.vertex_count);
    MeshPlaces places(symbols_, header_.vertex_count, known);
    for (uint32_t v = 0; v < links_.vertex_count; ++v) {
      if (!places.group(v, v + 1)) return false;
    }
    vertex_places_ = places.take();
    setFaces(faces, links_.vertex, vertex_places_);
    return true;
  }

  // Codes UV indices: vertex by vertex in the faces' order of vertices; arbitrary order within a vertex.
  bool codeUvPlaces() {
    const std::vector<uint32_t> first = rankUvs();
    auto& faces = contents_.mesh.topology.face_uvs;
    const auto known = known_.places(links_.uv, faces, header_.uv_count);
    MeshPlaces places(symbols_, header_.uv_count, known);
    std::vector<uint8_t> met(links_.vertex_count);
    for (uint32_t v : links_.vertex) {
      if (met[v]) continue;
      met[v] = true;
      if (!places.group(first[v], first[v + 1])) return false;
    }
    uv_places_ = places.take();
    setFaces(faces, links_.uv, uv_places_);
    return true;
  }

  // Ranks UVs by their first vertex. Returns the first UV of each vertex, and the end.
  std::vector<uint32_t> rankUvs() {
    const CornersOf corners(links_.vertex, links_.vertex_count);
    std::vector<uint32_t> order(links_.uv_count), first(size_t(links_.vertex_count) + 1);
    std::vector<uint8_t> met(links_.uv_count);
    uint32_t end = 0;
    for (uint32_t v = 0; v < links_.vertex_count; ++v) {
      for (uint32_t c : corners.of(v)) {
        if (!met[links_.uv[c]]) order[end++] = links_.uv[c];
        met[links_.uv[c]] = true;
      }
      first[v + 1] = end;
    }
    rank(links_.uv, order);
    return first;
  }

  static void setFaces(std::vector<glm::uvec3>& faces, const std::vector<uint32_t>& item,
                       const std::vector<uint32_t>& places) {
    for (uint32_t c = 0; c < item.size(); ++c) faces[c / 3][c % 3] = places[item[c]];
  }

  bool codeValues() {
    BaseMesh& mesh = contents_.mesh;
    return codeAttribute(nullptr, header_.positions, vertex_places_, contents_.position_q, &mesh.positions[0].x, 3) &&
           codeAttribute(&mesh, header_.uvs, uv_places_, contents_.uv_q, &mesh.topology.uvs[0].x, 2);
  }

  // Reconstructs values from q, or codes their raw bits.
  bool codeAttribute(const BaseMesh* mesh, const MeshGrid& grid, const std::vector<uint32_t>& places,
                     const std::vector<glm::ivec3>& known, float* values, uint32_t components) {
    std::vector<glm::ivec3> q(places.size());
    for (size_t i = 0; i < known.size(); ++i) q[i] = known[places[i]];
    if (grid.step != 0 && !codeQuantised(coder_, links_, mesh, q)) return false;
    for (size_t i = 0; i < q.size(); ++i) {
      for (uint32_t k = 0; k < components; ++k) {
        float& value = values[places[i] * components + k];
        value = grid.step != 0 ? static_cast<float>(q[i][k]) * grid.step + grid.min[k] : codeFloat(value);
        if (!std::isfinite(value)) return false;
      }
    }
    return true;
  }
  float codeFloat(float value) {
    uint32_t bits;
    std::memcpy(&bits, &value, 4);
    bits = symbols_.plain(32, bits);
    std::memcpy(&value, &bits, 4);
    return value;
  }

  Coder& coder_;
  MeshSymbols<Coder> symbols_;
  Known& known_;
  const MeshHeader& header_;
  MeshContents& contents_;
  MeshLinks links_;
  std::vector<uint32_t> vertex_places_, uv_places_;  // [item] index in the mesh
};

}  // namespace fourdvt::package

// SPDX-License-Identifier: Apache-2.0
#include "track/mesh/half_edges.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "base/text.h"

namespace fourdvt::track {

Result<HalfEdges> HalfEdges::of(const std::vector<glm::uvec3>& faces, Positions& positions) {
  HalfEdges out;
  out.faces_ = faces.size();
  out.from_.reserve(3 * faces.size());
  for (const glm::uvec3& f : faces) out.from_.insert(out.from_.end(), {f.x, f.y, f.z});
  FOURDVT_TRY(out.pair());
  out.separateFans(positions);
  return out;
}

// Finds the twins by sorting the half-edges by their ends.
Status HalfEdges::pair() {
  struct Ends {
    uint64_t key;  // the lower vertex in the upper half
    uint32_t half_edge;
  };
  std::vector<Ends> ends;
  ends.reserve(from_.size());
  for (uint32_t h = 0; h < from_.size(); ++h) {
    const uint64_t a = from(h), b = to(h);
    ends.push_back({std::min(a, b) << 32 | std::max(a, b), h});
  }
  std::sort(ends.begin(), ends.end(),
            [](const Ends& a, const Ends& b) { return a.key != b.key ? a.key < b.key : a.half_edge < b.half_edge; });
  twin_.assign(from_.size(), kNone);
  for (size_t i = 0; i < ends.size(); i += 2) {
    const uint32_t h = ends[i].half_edge;
    const bool paired = i + 1 < ends.size() && ends[i + 1].key == ends[i].key &&
                        (i + 2 == ends.size() || ends[i + 2].key != ends[i].key) &&
                        from(h) == to(ends[i + 1].half_edge) && from(h) != to(h);
    if (!paired)
      return Error{ErrorId::MeshTopology,
                   printed("surface: the edge of vertices %u and %u has not two faces of opposite direction; close the "
                           "surface and orient its faces",
                           from(h), to(h))};
    join(h, ends[i + 1].half_edge);
  }
  return {};
}

void HalfEdges::separateFans(Positions& positions) {
  outgoing_.assign(positions.size(), kNone);
  std::vector<bool> seen(from_.size(), false);
  for (uint32_t first = 0; first < from_.size(); ++first) {
    if (seen[first]) continue;
    uint32_t vertex = from_[first];
    if (outgoing_[vertex] != kNone) {
      positions.push_back(glm::vec3(positions[vertex]));
      vertex = uint32_t(outgoing_.size());
      outgoing_.push_back(kNone);
    }
    outgoing_[vertex] = first;
    around(vertex, [&](uint32_t h) {
      seen[h] = true;
      from_[h] = vertex;
    });
  }
}

int HalfEdges::valence(uint32_t v) const {
  int count = 0;
  around(v, [&](uint32_t) { ++count; });
  return count;
}

bool HalfEdges::adjacent(uint32_t a, uint32_t b) const {
  bool found = false;
  around(a, [&](uint32_t h) { found |= to(h) == b; });
  return found;
}

bool HalfEdges::mayCollapse(uint32_t h) const {
  const uint32_t a = from(h), b = to(h), c = opposite(h), d = opposite(twin(h));
  if (c == d || valence(c) <= 3 || valence(d) <= 3) return false;
  bool may = true;
  around(a, [&](uint32_t out) {
    const uint32_t v = to(out);
    if (may && v != b && v != c && v != d) may = !adjacent(b, v);
  });
  return may;
}

bool HalfEdges::mayFlip(uint32_t h) const {
  const uint32_t a = from(h), b = to(h), c = opposite(h), d = opposite(twin(h));
  return c != d && valence(a) > 3 && valence(b) > 3 && !adjacent(c, d);
}

void HalfEdges::collapse(uint32_t h) {
  assert(mayCollapse(h));
  const uint32_t t = twin(h), a = from(h), b = to(h), c = opposite(h), d = opposite(t);
  const uint32_t to_c = twin(previous(h)), from_c = twin(next(h));  // a → c, c → b
  const uint32_t to_d = twin(previous(t)), from_d = twin(next(t));  // b → d, d → a
  std::vector<uint32_t> moved;
  around(b, [&](uint32_t out) { moved.push_back(out); });
  for (const uint32_t out : moved) from_[out] = a;
  join(to_c, from_c);
  join(to_d, from_d);
  outgoing_[a] = to_c;
  outgoing_[b] = kNone;
  outgoing_[c] = from_c;
  outgoing_[d] = from_d;
  for (const uint32_t gone : {h, next(h), previous(h), t, next(t), previous(t)}) from_[gone] = twin_[gone] = kNone;
  faces_ -= 2;
}

void HalfEdges::flip(uint32_t h) {
  assert(mayFlip(h));
  const uint32_t t = twin(h), a = from(h), b = to(h), c = opposite(h), d = opposite(t);
  const uint32_t n = next(h), p = previous(h), tn = next(t), tp = previous(t);
  const uint32_t bc = twin(n), ca = twin(p), ad = twin(tn), db = twin(tp);  // outside the two faces
  const std::pair<uint32_t, uint32_t> origins[] = {{h, d}, {n, c}, {p, a}, {t, c}, {tn, d}, {tp, b}};
  for (const auto& [half_edge, vertex] : origins) {
    from_[half_edge] = vertex;
    outgoing_[vertex] = half_edge;
  }
  join(n, ca);
  join(p, ad);
  join(tn, db);
  join(tp, bc);
}

uint32_t HalfEdges::split(uint32_t h) {
  const uint32_t t = twin(h), a = from(h), b = to(h), c = opposite(h), d = opposite(t);
  const uint32_t n = next(h), tp = previous(t), bc = twin(n), db = twin(tp);
  const uint32_t middle = uint32_t(outgoing_.size()), one = uint32_t(from_.size()), two = one + 3;
  from_.insert(from_.end(), {middle, b, c, b, middle, d});
  twin_.resize(from_.size(), kNone);
  from_[n] = from_[t] = middle;
  join(n, one + 2);
  join(one, two);
  join(one + 1, bc);
  join(tp, two + 1);
  join(two + 2, db);
  outgoing_.push_back(one);
  outgoing_[a] = h;
  outgoing_[b] = one + 1;
  outgoing_[c] = previous(h);
  outgoing_[d] = tp;
  faces_ += 2;
  return middle;
}

std::vector<glm::uvec3> HalfEdges::faces() const {
  std::vector<glm::uvec3> out;
  out.reserve(faces_);
  for (uint32_t h = 0; h < from_.size(); h += 3)
    if (hasHalfEdge(h)) out.emplace_back(from_[h], from_[h + 1], from_[h + 2]);
  return out;
}

}  // namespace fourdvt::track

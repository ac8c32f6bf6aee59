// SPDX-License-Identifier: Apache-2.0
// Codes the vertex and UV indices of a base mesh's faces, for encoder and decoder. The walk goes from the last face to
// the first: backwards through Draco's order, so that nearly every face is attached to the face before it. Integers
// only. Exact definition: FORMAT.md, "The mesh in the start file". Internal to package/.
#pragma once

#include <algorithm>

#include "package/binary_coder.h"

namespace fourdvt::package {

constexpr uint32_t kNone = UINT32_MAX;

// Codes decisions and numbers; each context has its own adaptive probability.
template <class Coder>
class MeshSymbols {
 public:
  explicit MeshSymbols(Coder& coder) : coder_(coder), bits_(kContexts) {}
  bool bit(uint32_t context, bool value) {
    AdaptiveBit& a = bits_[context];
    value = coder_.code(value, std::clamp<uint32_t>(a.p16(), 32, 65504));
    a.update(value, kLimit);
    return value;
  }
  // Codes the lowest `count` bits, highest first, equally probable.
  uint32_t plain(int count, uint32_t value) {
    uint32_t out = 0;
    while (count-- > 0) out = out * 2 + coder_.code(value >> count & 1, 32768);
    return out;
  }
  // Codes a value below 2^31 - 1, small ones in few bits; takes 30 contexts.
  uint32_t number(uint32_t context, uint32_t value) {
    int size = 0;
    while (size < 30 && bit(context + size, (value + 1) >> size > 1)) ++size;
    return (1u << size) + plain(size, value + 1) - 1;
  }

 private:
  static constexpr uint32_t kContexts = 1400, kLimit = 60;
  Coder& coder_;
  std::vector<AdaptiveBit> bits_;
};

// Contexts of MeshSymbols. From kFresh and kGlued on: one per degrees of two vertices and kind of the last face.
enum MeshContext : uint32_t {
  kFresh = 0,
  kGlued = 256,
  kUv = 1024,
  kFreeFresh = 1120,
  kAttached = 1121,
  kGate = 1123,
  kTip = 1124,
  kOnLoop = 1130,
  kBackwards = 1131,
  kNewUv = 1132,
  kInOrder = 1134,
  kFirstOfVertex = 1135,
  kSteps = 1140,
  kVertexNumber = 1170,
  kUvNumber = 1200,
  kPlace = 1230,
};

// Corner k of face f is 3 f + k; the half-edge of a corner runs from it to the next corner of its face.
inline uint32_t nextCorner(uint32_t c) { return c % 3 == 2 ? c - 2 : c + 1; }
inline uint32_t previousCorner(uint32_t c) { return c % 3 == 0 ? c + 2 : c - 1; }

struct MeshLinks {
  std::vector<uint32_t> vertex, uv;  // [corner] numbered by first appearance in the walk
  std::vector<uint32_t> across;      // [half-edge] twin in the neighbouring face; kNone: open
  uint32_t vertex_count = 0, uv_count = 0;

  explicit MeshLinks(uint32_t faces) : vertex(3 * size_t(faces), kNone), uv(vertex), across(vertex) {}
  // Corner of the neighbouring face that does not lie on the edge opposite to `c`.
  uint32_t oppositeCorner(uint32_t c) const {
    const uint32_t h = across[nextCorner(c)];
    return h == kNone ? kNone : previousCorner(h);
  }
};

// Known: the encoder's mesh (mesh_code_encode.cpp), or the decoder's stand-in (mesh_code.cpp).
template <class Coder, class Known>
class MeshWalk {
 public:
  MeshWalk(MeshSymbols<Coder>& symbols, Known& known, MeshLinks& links, uint32_t max_vertices, uint32_t max_uvs)
      : symbols_(symbols),
        known_(known),
        links_(links),
        max_vertices_(max_vertices),
        max_uvs_(max_uvs),
        next_(links.vertex.size()),
        previous_(next_),
        at_(max_vertices) {}

  // Codes one face; false: damaged bytes.
  bool face(uint32_t f) {
    const uint32_t gate = takeGate(3 * f);
    return gate == kNone ? freeFace(3 * f) : attachedFace(3 * f, gate);
  }

 private:
  static constexpr uint32_t kMaxSteps = 63, kMaxDegree = 7;
  enum Kind : uint32_t { Fresh, Right, Left, Far };
  enum Role : uint32_t { GateEnd, GateStart, Tip, Free };
  struct AtVertex {
    uint32_t degree = 0, uv_count = 0, last_uv = kNone;
  };
  // Face at a gate from a to b: its corners are b, a and the tip. left, right: the boundary half-edges before and after
  // the gate, glued to the face.
  struct Attached {
    uint32_t gate, b, a, tip, before, after;
    bool left = false, right = false;
    uint32_t split = kNone;  // half-edge at the tip
  };

  bool isOpen(uint32_t h) const { return links_.across[h] == kNone; }
  void link(uint32_t a, uint32_t b) { next_[a] = b, previous_[b] = a; }
  void join(uint32_t a, uint32_t b) { links_.across[a] = b, links_.across[b] = a; }
  void glue(uint32_t a, uint32_t b) {
    join(a, b);
    link(previous_[a], next_[b]);
  }

  uint32_t takeGate(uint32_t first) {
    while (!stack_.empty() && !isOpen(stack_.back())) stack_.pop_back();
    if (stack_.empty()) return kNone;
    attached_ = symbols_.bit(kAttached + attached_, known_.attaches(links_, stack_, first));
    while (attached_ && !stack_.empty()) {
      const uint32_t h = stack_.back();
      stack_.pop_back();
      if (isOpen(h) && symbols_.bit(kGate, known_.cornerAt(h, first) != kNone)) return h;
    }
    return kNone;
  }

  bool freeFace(uint32_t first) {
    for (uint32_t c = first; c < first + 3; ++c) {
      links_.vertex[c] = symbols_.bit(kFreeFresh, known_.newVertex(c)) ? addVertex(c) : anyVertex(c);
      if (links_.vertex[c] == kNone || !codeUv(c, Free, {kNone, kNone})) return false;
      link(c, nextCorner(c));
    }
    for (uint32_t k : {0, 2, 1}) stack_.push_back(first + k);
    return true;
  }

  bool attachedFace(uint32_t first, uint32_t gate) {
    Attached f = attach(first, gate);
    links_.vertex[f.tip] = codeTip(f);
    if (links_.vertex[f.tip] == kNone || !codeUvs(f)) return false;
    if (f.left) glue(f.before, f.a);
    if (f.right) glue(f.tip, f.after);
    stack_.push_back(f.tip);
    stack_.push_back(f.a);
    return true;
  }

  Attached attach(uint32_t first, uint32_t gate) {
    const uint32_t known_tip = previousCorner(known_.cornerAt(gate, first));
    tip_ = symbols_.bit(kTip + 2 * tip_, known_tip > first)
               ? 1 + symbols_.bit(kTip + 2 * tip_ + 1, known_tip > first + 1)
               : 0;
    const uint32_t tip = first + tip_, b = nextCorner(tip), a = nextCorner(b);
    links_.vertex[b] = links_.vertex[nextCorner(gate)];
    links_.vertex[a] = links_.vertex[gate];
    join(gate, b);
    const Attached f{gate, b, a, tip, previous_[gate], next_[gate]};
    link(f.before, a), link(a, tip), link(tip, f.after);
    return f;
  }

  uint32_t codeTip(Attached& f) {
    const uint32_t context = 64 * kind_ + 8 * degree(f.a) + degree(f.b);
    kind_ = Fresh;
    if (symbols_.bit(kFresh + context, known_.newVertex(f.tip))) return addVertex(f.tip);
    const uint32_t x = links_.vertex[f.before], y = links_.vertex[nextCorner(f.after)];
    const bool loop = f.before != f.after && f.before != f.gate;
    f.right = loop && symbols_.bit(kGlued + 3 * context, known_.opposite(f.after, f.tip));
    f.left = loop && (!f.right || x == y) &&
             symbols_.bit(kGlued + 3 * context + 1 + f.right, known_.opposite(f.before, f.a));
    kind_ = f.left ? Left : f.right ? Right : Far;
    return f.left ? x : f.right ? y : farTip(f);
  }
  uint32_t degree(uint32_t c) const { return std::min(at_[links_.vertex[c]].degree, kMaxDegree); }

  // Codes a tip away from the gate: a vertex elsewhere on the boundary, which the face then divides, or any other
  // vertex.
  uint32_t farTip(Attached& f) {
    const uint32_t way = known_.wayTo(f.tip, f.before, f.after, next_, previous_, kMaxSteps);
    if (!symbols_.bit(kOnLoop, way != kNone)) return anyVertex(f.tip);
    const bool backwards = symbols_.bit(kBackwards, way & 1);
    const uint32_t steps = symbols_.number(kSteps, way >> 1);
    if (steps > kMaxSteps) return kNone;
    f.split = backwards ? f.before : next_[f.after];
    for (uint32_t i = 0; i < steps; ++i) f.split = backwards ? previous_[f.split] : next_[f.split];
    if (f.split == f.tip || f.split == f.a) return kNone;
    link(previous_[f.split], f.tip);
    link(f.a, f.split);
    return links_.vertex[f.split];
  }

  uint32_t addVertex(uint32_t c) {
    if (links_.vertex_count == max_vertices_) return kNone;
    known_.addVertex(c, links_.vertex_count);
    return links_.vertex_count++;
  }
  uint32_t anyVertex(uint32_t c) {
    const uint32_t back = symbols_.number(kVertexNumber, links_.vertex_count - 1 - known_.vertex(c));
    return back < links_.vertex_count ? links_.vertex_count - 1 - back : kNone;
  }

  bool codeUvs(const Attached& f) {
    const auto& uv = links_.uv;
    const uint32_t right = f.right ? uv[f.after] : kNone, left = f.left ? uv[nextCorner(f.before)] : kNone;
    const uint32_t far_right = f.right ? uv[nextCorner(f.after)] : kNone;
    const uint32_t far_left = f.left ? uv[f.before] : f.split != kNone ? uv[f.split] : kNone;
    return codeUv(f.b, GateEnd, {uv[nextCorner(f.gate)], right}) && codeUv(f.a, GateStart, {uv[f.gate], left}) &&
           codeUv(f.tip, Tip, {far_right, far_left});
  }

  // beside: UVs of neighbouring faces at the corner's vertex.
  bool codeUv(uint32_t c, Role role, const std::array<uint32_t, 2>& beside) {
    AtVertex& at = at_[links_.vertex[c]];
    ++at.degree;
    if (role == GateEnd) seam_ = false;
    const uint32_t context = kUv + 24 * role + 8 * std::min(at.uv_count, 2u) + 4 * seam_;
    const uint32_t tried[3] = {beside[0], beside[1], at.last_uv};
    uint32_t& out = links_.uv[c];
    for (uint32_t i = 0; i < 3; ++i) {
      if (tried[i] == kNone || (i > 0 && tried[i] == tried[0]) || (i > 1 && tried[i] == tried[1])) continue;
      const bool same = symbols_.bit(context + i, known_.uv(c) == tried[i]);
      if (i == 0) seam_ = !same;
      if (same) return out = at.last_uv = tried[i], true;
    }
    out = symbols_.bit(kNewUv + (at.uv_count > 0), known_.newUv(c)) ? addUv(c, at) : anyUv(c);
    at.last_uv = out;
    return out != kNone;
  }
  uint32_t addUv(uint32_t c, AtVertex& at) {
    if (links_.uv_count == max_uvs_) return kNone;
    ++at.uv_count;
    known_.addUv(c, links_.uv_count);
    return links_.uv_count++;
  }
  uint32_t anyUv(uint32_t c) {
    const uint32_t back = symbols_.number(kUvNumber, links_.uv_count - 1 - known_.uv(c));
    return back < links_.uv_count ? links_.uv_count - 1 - back : kNone;
  }

  MeshSymbols<Coder>& symbols_;
  Known& known_;
  MeshLinks& links_;
  const uint32_t max_vertices_, max_uvs_;
  std::vector<uint32_t> next_, previous_;  // [half-edge] on the boundary of the faces so far
  std::vector<uint32_t> stack_;            // candidate gates
  std::vector<AtVertex> at_;
  uint32_t tip_ = 0, kind_ = Fresh;
  bool attached_ = false, seam_ = false;
};

}  // namespace fourdvt::package

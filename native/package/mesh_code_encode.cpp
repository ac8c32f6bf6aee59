// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <unordered_map>

#include "base/bytes.h"
#include "package/mesh_code.h"
#include "package/mesh_model.h"

namespace fourdvt::package {
namespace {

Error meshFailed(const char* what) { return {ErrorId::Internal, std::string("base mesh: ") + what}; }

// MeshWalk's queries, answered from the mesh.
class KnownMesh {
 public:
  explicit KnownMesh(const MeshTopology& topology)
      : topology_(topology), vertices_(topology.vertex_count, kNone), uvs_(topology.uvs.size(), kNone) {
    for (uint32_t h = 0; h < 3 * topology.faceCount(); ++h) ++to_come_[edge(h)];
  }
  bool lost() const { return false; }

  // Returns true if the face attaches to an edge on the stack. Edges above that one are then dropped, so no later face
  // may contain them.
  bool attaches(const MeshLinks& links, const std::vector<uint32_t>& stack, uint32_t first) {
    constexpr ptrdiff_t kMaxSearch = 4096;
    for (uint32_t h = first; h < first + 3; ++h) --to_come_[edge(h)];
    for (auto h = stack.rbegin(); h != stack.rend() && h - stack.rbegin() < kMaxSearch; ++h) {
      if (links.across[*h] != kNone) continue;
      if (cornerAt(*h, first) != kNone) return true;
      const auto found = to_come_.find(reversed(*h));
      if (found != to_come_.end() && found->second > 0) return false;
    }
    return false;
  }
  // Corner of the face whose half-edge is opposite to h.
  uint32_t cornerAt(uint32_t h, uint32_t first) const {
    for (uint32_t c = first; c < first + 3; ++c) {
      if (opposite(h, c)) return c;
    }
    return kNone;
  }
  bool opposite(uint32_t a, uint32_t b) const { return edge(a) == reversed(b); }

  bool newVertex(uint32_t c) const { return vertex(c) == kNone; }
  void addVertex(uint32_t c, uint32_t number) { vertices_[vertexAt(c)] = number; }
  uint32_t vertex(uint32_t c) const { return vertices_[vertexAt(c)]; }
  bool newUv(uint32_t c) const { return uv(c) == kNone; }
  void addUv(uint32_t c, uint32_t number) { uvs_[uvAt(c)] = number; }
  uint32_t uv(uint32_t c) const { return uvs_[uvAt(c)]; }

  // Twice the steps along the boundary to a half-edge at the vertex, plus 1 backwards.
  uint32_t wayTo(uint32_t tip, uint32_t before, uint32_t after, const std::vector<uint32_t>& next,
                 const std::vector<uint32_t>& previous, uint32_t max_steps) const {
    uint32_t ahead = next[after], behind = before;
    const auto ends = [&](uint32_t h) { return h == tip || h == previousCorner(tip); };
    for (uint32_t steps = 0; steps <= max_steps && !ends(ahead) && !ends(behind); ++steps) {
      if (vertexAt(ahead) == vertexAt(tip)) return 2 * steps;
      if (vertexAt(behind) == vertexAt(tip)) return 2 * steps + 1;
      ahead = next[ahead], behind = previous[behind];
    }
    return kNone;
  }
  static std::vector<uint32_t> places(const std::vector<uint32_t>& item, const std::vector<glm::uvec3>& faces,
                                      uint32_t count) {
    std::vector<uint32_t> out(count);
    for (uint32_t c = 0; c < item.size(); ++c) out[item[c]] = faces[c / 3][c % 3];
    return out;
  }

 private:
  uint32_t vertexAt(uint32_t c) const { return topology_.face_vertices[c / 3][c % 3]; }
  uint32_t uvAt(uint32_t c) const { return topology_.face_uvs[c / 3][c % 3]; }
  static uint64_t key(uint32_t from, uint32_t to) { return uint64_t(from) << 32 | to; }
  uint64_t edge(uint32_t h) const { return key(vertexAt(h), vertexAt(nextCorner(h))); }
  uint64_t reversed(uint32_t h) const { return key(vertexAt(nextCorner(h)), vertexAt(h)); }

  const MeshTopology& topology_;
  std::vector<uint32_t> vertices_, uvs_;  // numbers in the walk
  std::unordered_map<uint64_t, uint32_t> to_come_;
};

// Grid integers that reproduce the values exactly; false: a value off the grid.
template <class Vec>
bool quantise(const std::vector<Vec>& values, const MeshGrid& grid, std::vector<glm::ivec3>& q) {
  for (size_t i = 0; i < values.size(); ++i) {
    for (int k = 0; k < int(sizeof(Vec) / sizeof(float)); ++k) {
      const double steps = std::round((double(values[i][k]) - grid.min[k]) / grid.step);
      if (!(std::abs(steps) <= kMaxQuantised)) return false;
      q[i][k] = static_cast<int>(steps);
      const float back = static_cast<float>(q[i][k]) * grid.step + grid.min[k];
      if (std::memcmp(&back, &values[i][k], 4) != 0) return false;
    }
  }
  return true;
}

// Recovers Draco's grid: origin = minimum value, step = longest side / (2^bits - 1).
template <class Vec>
MeshGrid findGrid(const std::vector<Vec>& values, std::vector<glm::ivec3>& q) {
  q.resize(values.size());
  constexpr int kMaxBits = 22, kMaxUlps = 4;
  Vec low = values[0], high = values[0];
  for (const Vec& v : values) low = glm::min(low, v), high = glm::max(high, v);
  float side = 0;
  MeshGrid grid;
  for (int k = 0; k < int(sizeof(Vec) / sizeof(float)); ++k)
    grid.min[k] = low[k], side = std::max(side, high[k] - low[k]);
  if (!(side > 0)) side = 1;
  for (int ulps = 0; ulps < kMaxUlps; ++ulps) side = std::nextafter(side, 0.0f);
  for (int ulps = -kMaxUlps; ulps <= kMaxUlps; ++ulps, side = std::nextafter(side, 1e38f)) {
    for (int bits = 1; bits <= kMaxBits; ++bits) {
      grid.step = side / static_cast<float>((1 << bits) - 1);
      if (std::isnormal(grid.step) && quantise(values, grid, q)) return grid;
    }
  }
  return {};
}

template <class Vec>
bool finite(const std::vector<Vec>& values) {
  return std::all_of(values.begin(), values.end(), [](const Vec& v) {
    for (int k = 0; k < int(sizeof(Vec) / sizeof(float)); ++k) {
      if (!std::isfinite(v[k])) return false;
    }
    return true;
  });
}

bool below(const std::vector<glm::uvec3>& faces, size_t count) {
  return std::all_of(faces.begin(), faces.end(), [&](const glm::uvec3& f) {
    return std::max({f.x, f.y, f.z}) < count;
  });
}

const char* whyNot(const BaseMesh& mesh) {
  const MeshTopology& t = mesh.topology;
  if (t.faceCount() < 1 || t.faceCount() > kMaxFaces || t.face_uvs.size() != t.faceCount()) return "bad face counts";
  if (t.vertex_count < 3 || t.vertex_count > 3 * t.faceCount() || mesh.positions.size() != t.vertex_count)
    return "bad vertex counts";
  if (t.uvs.empty() || t.uvs.size() > 3 * t.faceCount()) return "bad UV counts";
  if (!below(t.face_vertices, t.vertex_count) || !below(t.face_uvs, t.uvs.size())) return "face index out of range";
  return finite(mesh.positions) && finite(t.uvs) ? nullptr : "bad values";
}

template <class Vec>
bool sameBits(const std::vector<Vec>& a, const std::vector<Vec>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec)) == 0;
}

bool sameMesh(const BaseMesh& a, const BaseMesh& b) {
  return a.topology.vertex_count == b.topology.vertex_count && sameBits(a.positions, b.positions) &&
         sameBits(a.topology.uvs, b.topology.uvs) && a.topology.face_vertices == b.topology.face_vertices &&
         a.topology.face_uvs == b.topology.face_uvs;
}

void writeGrid(const MeshGrid& grid, int components, ByteWriter& out) {
  for (int k = 0; k < components; ++k) out.f32(grid.min[k]);
  out.f32(grid.step);
}

}  // namespace

Result<std::vector<uint8_t>> encodeMeshCode(const BaseMesh& decoded) {
  if (const char* what = whyNot(decoded)) return meshFailed(what);
  const MeshTopology& t = decoded.topology;
  MeshHeader h{t.vertex_count, static_cast<uint32_t>(t.uvs.size()), t.faceCount(), {}, {}};
  MeshContents contents(h);
  contents.mesh = decoded;
  h.positions = findGrid(decoded.positions, contents.position_q);
  h.uvs = findGrid(t.uvs, contents.uv_q);
  ByteWriter out;
  for (uint32_t count : {h.vertex_count, h.uv_count, h.face_count}) out.u32(count);
  writeGrid(h.positions, 3, out);
  writeGrid(h.uvs, 2, out);
  KnownMesh known(t);
  BinaryEncoder coder;
  MeshModel(coder, known, h, contents).code();
  out.bytes(coder.take());
  const auto back = decodeMeshCode(out.data());
  if (!back || !sameMesh(back.value(), decoded)) return meshFailed("its own coding does not give it back");
  return out.take();
}

}  // namespace fourdvt::package

// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "track/mesh/atlas.h"
#include "track/mesh/triangle.h"

namespace fourdvt::track {
namespace {

// Joins faces with common texture vertices along an edge, and sums the seams.
class Charts {
 public:
  Charts(const MeshTopology& t, const Positions& positions) : parents_(t.faceCount()) {
    std::iota(parents_.begin(), parents_.end(), 0u);
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> by_uvs;
    std::map<std::pair<uint32_t, uint32_t>, bool> seams;  // by vertices
    for (uint32_t f = 0; f < t.faceCount(); ++f)
      for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        const auto [it, fresh] = by_uvs.try_emplace(std::minmax(t.face_uvs[f][k], t.face_uvs[f][next]), f);
        if (!fresh) parents_[root(f)] = root(it->second);
        seams[std::minmax(t.face_vertices[f][k], t.face_vertices[f][next])] = fresh;
      }
    for (const auto& [edge, seam] : seams)
      if (seam) seam_m += glm::length(glm::dvec3(positions[edge.second]) - glm::dvec3(positions[edge.first]));
  }
  uint32_t root(uint32_t f) {
    while (parents_[f] != f) f = parents_[f] = parents_[parents_[f]];
    return f;
  }
  double seam_m = 0;

 private:
  std::vector<uint32_t> parents_;
};

// Counts the faces over each texel's centre; a centre on an edge belongs to the faces whose inside lies above or left.
uint32_t overlaps(const MeshTopology& t, int texels) {
  std::vector<uint8_t> covered(size_t(texels) * size_t(texels), 0);
  for (const glm::uvec3& uvs : t.face_uvs) {
    glm::dvec2 p[3];
    for (int k = 0; k < 3; ++k) p[k] = glm::dvec2(t.uvs[uvs[k]]) * double(texels);
    const double low = std::min({p[0].y, p[1].y, p[2].y}), high = std::max({p[0].y, p[1].y, p[2].y});
    for (int y = std::max(0, int(std::ceil(low - 0.5))); y < texels && y + 0.5 < high; ++y) {
      double ends[2] = {1e300, -1e300};
      for (int k = 0; k < 3; ++k) {
        const bool down = p[k].y <= p[(k + 1) % 3].y;
        const glm::dvec2 a = down ? p[k] : p[(k + 1) % 3], b = down ? p[(k + 1) % 3] : p[k];
        if (!(a.y <= y + 0.5 && y + 0.5 < b.y)) continue;
        const double x = a.x + (y + 0.5 - a.y) / (b.y - a.y) * (b.x - a.x);
        ends[0] = std::min(ends[0], x);
        ends[1] = std::max(ends[1], x);
      }
      for (int x = std::max(0, int(std::ceil(ends[0] - 0.5))); x < texels && x + 0.5 < ends[1]; ++x) {
        uint8_t& count = covered[size_t(y) * size_t(texels) + size_t(x)];
        if (count < 2) ++count;
      }
    }
  }
  uint32_t out = 0;
  for (const uint8_t count : covered) out += count > 1;
  return out;
}

struct Sums {
  double surface = 0, flat = 0, squares = 0, longest = 0;
};

}  // namespace

AtlasQuality atlasQuality(const MeshTopology& topology, const Positions& positions, int texels) {
  AtlasQuality out;
  Charts charts(topology, positions);
  std::map<uint32_t, Sums> by_chart;
  for (uint32_t f = 0; f < topology.faceCount(); ++f) {
    const glm::uvec3 &v = topology.face_vertices[f], &uv = topology.face_uvs[f];
    const FlatTriangle triangle(positions[v.x], positions[v.y], positions[v.z]);
    const auto up = [&](uint32_t i) { return glm::dvec2(topology.uvs[i].x, -topology.uvs[i].y); };
    const TriangleStretch stretch = triangle.stretch(up(uv.x), up(uv.y), up(uv.z));
    Sums& sums = by_chart[charts.root(f)];
    out.flipped_faces += !(stretch.flat_area > 0);
    out.packed_share += std::abs(stretch.flat_area);
    sums.surface += triangle.area();
    sums.flat += std::abs(stretch.flat_area);
    sums.squares += triangle.area() * stretch.square;
    sums.longest = std::max(sums.longest, stretch.longest);
  }
  double surface = 0, squares = 0;
  for (const auto& [root, sums] : by_chart) {
    surface += sums.surface;
    squares += sums.squares * sums.flat / sums.surface;
    out.stretch_max = std::max(out.stretch_max, sums.longest * std::sqrt(sums.flat / sums.surface));
  }
  out.charts = uint32_t(by_chart.size());
  out.stretch_l2 = surface > 0 ? std::sqrt(squares / surface) : 0;
  out.overlapping_texels = overlaps(topology, texels);
  out.seam_m = charts.seam_m;
  return out;
}

}  // namespace fourdvt::track

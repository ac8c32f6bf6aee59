// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/actors/atlas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace fourdvt::studio {
namespace {

constexpr int kDirections = 6;      // ±x, ±y, ±z of the part
constexpr double kMargin = 0.008;   // gap round every chart, as a share of the atlas's side
constexpr size_t kSmallChart = 12;  // faces; smaller charts join a neighbour if kMinFacing allows it
constexpr double kMinFacing = 0.3;  // smallest cosine between a face's normal and its chart's direction

using Neighbours = std::vector<std::array<int, 3>>;

struct Chart {
  int label = 0;
  std::vector<uint32_t> faces;
  glm::dvec2 min{1e9}, max{-1e9};  // metres
  glm::dvec2 at{0};                // position of `min` in the atlas
};

class Unwrapper {
 public:
  Unwrapper(RestMesh& mesh, const std::function<int(const glm::vec3&)>& part) : mesh_(mesh) {
    findNeighbours();
    label(part);
    for (int i = 0; i < 3; ++i) smooth();
    for (int i = 0; i < 3; ++i) mergeSmall();
  }

  void run() {
    std::vector<Chart> charts = findCharts();
    for (Chart& chart : charts)
      for (const uint32_t f : chart.faces)
        for (int k = 0; k < 3; ++k) {
          const glm::dvec2 p = flat(f, k);
          chart.min = glm::min(chart.min, p);
          chart.max = glm::max(chart.max, p);
        }
    double low = 0, high = 16;  // scale: sides of the atlas per metre
    for (int i = 0; i < 24; ++i) {
      const double scale = 0.5 * (low + high);
      (pack(charts, scale) ? low : high) = scale;
    }
    pack(charts, low);
    write(charts, low);
  }

 private:
  const glm::uvec3& face(uint32_t f) const { return mesh_.topology.face_vertices[f]; }
  size_t faceCount() const { return mesh_.topology.face_vertices.size(); }

  void findNeighbours() {
    neighbours_.assign(faceCount(), {-1, -1, -1});
    std::map<std::pair<uint32_t, uint32_t>, std::pair<uint32_t, int>> open;
    for (uint32_t f = 0; f < faceCount(); ++f)
      for (int k = 0; k < 3; ++k) {
        const auto [it, fresh] = open.try_emplace(std::minmax(face(f)[k], face(f)[(k + 1) % 3]), std::pair{f, k});
        if (fresh) continue;
        neighbours_[f][k] = static_cast<int>(it->second.first);
        neighbours_[it->second.first][it->second.second] = static_cast<int>(f);
      }
  }

  // Finds the axes of each part from its face normals; the third axis runs along the part.
  void label(const std::function<int(const glm::vec3&)>& part) {
    std::vector<int> parts(faceCount());
    std::map<int, glm::dvec3> along;
    std::map<int, std::pair<glm::dvec3, double>> centres;
    for (uint32_t f = 0; f < faceCount(); ++f) {
      const glm::dvec3 a = corner(f, 0), b = corner(f, 1), c = corner(f, 2);
      const glm::dvec3 centre = (a + b + c) / 3.0;
      parts[f] = part(glm::vec3(centre));
      normals_.push_back(glm::normalize(glm::cross(b - a, c - a)));
      centres[parts[f]].first += centre;
      centres[parts[f]].second += 1;
    }
    std::map<int, glm::dmat3> spread;
    for (uint32_t f = 0; f < faceCount(); ++f) {
      const auto& [sum, count] = centres[parts[f]];
      const glm::dvec3 d = (corner(f, 0) + corner(f, 1) + corner(f, 2)) / 3.0 - sum / count;
      spread.try_emplace(parts[f], glm::dmat3(0)).first->second += glm::outerProduct(d, d);
    }
    for (const auto& [p, matrix] : spread) axes_[p] = frameAlong(longest(matrix));
    for (uint32_t f = 0; f < faceCount(); ++f) {
      int best = 0;
      for (int d = 1; d < kDirections; ++d)
        if (glm::dot(direction(parts[f] * kDirections + d), normals_[f]) >
            glm::dot(direction(parts[f] * kDirections + best), normals_[f]))
          best = d;
      labels_.push_back(parts[f] * kDirections + best);
    }
  }

  // Finds the longest principal axis by power iteration.
  static glm::dvec3 longest(const glm::dmat3& spread) {
    glm::dvec3 axis(0.3, 0.9, 0.2);
    for (int i = 0; i < 100; ++i) axis = glm::normalize(spread * axis);
    return axis;
  }

  // Columns: right, along and front.
  static glm::dmat3 frameAlong(const glm::dvec3& along) {
    const glm::dvec3 helper = std::abs(along.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
    const glm::dvec3 right = glm::normalize(glm::cross(along, helper));
    return {right, along, glm::cross(right, along)};
  }

  glm::dvec3 corner(uint32_t f, int k) const { return mesh_.positions[face(f)[k]]; }
  glm::dvec3 direction(int label) const {
    const int d = label % kDirections;
    return axes_.at(label / kDirections)[d / 2] * (d % 2 ? -1.0 : 1.0);
  }
  bool mayWear(uint32_t f, int label) const { return glm::dot(direction(label), normals_[f]) > kMinFacing; }

  void smooth() {
    const std::vector<int> before = labels_;
    for (uint32_t f = 0; f < faceCount(); ++f)
      for (int k = 0; k < 3; ++k) {
        const int a = neighbours_[f][k], b = neighbours_[f][(k + 1) % 3];
        if (a >= 0 && b >= 0 && before[a] == before[b] && mayWear(f, before[a])) labels_[f] = before[a];
      }
  }

  void mergeSmall() {
    for (const Chart& chart : findCharts()) {
      if (chart.faces.size() >= kSmallChart) continue;
      for (const uint32_t f : chart.faces)
        for (const int n : neighbours_[f])
          if (n >= 0 && labels_[n] != chart.label && mayWear(f, labels_[n])) {
            labels_[f] = labels_[n];
            break;
          }
    }
  }

  std::vector<Chart> findCharts() const {
    std::vector<Chart> charts;
    std::vector<uint8_t> seen(faceCount(), 0);
    for (uint32_t seed = 0; seed < faceCount(); ++seed) {
      if (seen[seed]) continue;
      Chart chart;
      chart.label = labels_[seed];
      chart.faces.push_back(seed);
      seen[seed] = 1;
      for (size_t i = 0; i < chart.faces.size(); ++i)
        for (const int n : neighbours_[chart.faces[i]])
          if (n >= 0 && !seen[n] && labels_[n] == chart.label) {
            seen[n] = 1;
            chart.faces.push_back(static_cast<uint32_t>(n));
          }
      charts.push_back(std::move(chart));
    }
    return charts;
  }

  // Projects a corner onto its chart's plane, metres; x to the right and y up, seen from outside.
  glm::dvec2 flat(uint32_t f, int k) const {
    const int label = labels_[f];
    const glm::dmat3& axes = axes_.at(label / kDirections);
    const glm::dvec3 out = direction(label), up = label % kDirections / 2 == 1 ? axes[2] : axes[1];
    const glm::dvec3 p = corner(f, k);
    return {glm::dot(p, glm::cross(up, out)), glm::dot(p, up)};
  }

  // Packs the charts in shelves, the tallest first. Returns false if they do not fit at this scale.
  static bool pack(std::vector<Chart>& charts, double scale) {
    std::sort(charts.begin(), charts.end(), [](const Chart& a, const Chart& b) {
      const double ha = a.max.y - a.min.y, hb = b.max.y - b.min.y;
      return ha != hb ? ha > hb : a.faces[0] < b.faces[0];
    });
    double x = 0, y = 0, shelf = 0;
    for (Chart& chart : charts) {
      const glm::dvec2 size = scale * (chart.max - chart.min) + 2 * kMargin;
      if (x + size.x > 1) {
        x = 0;
        y += shelf;
        shelf = 0;
      }
      shelf = std::max(shelf, size.y);
      if (size.x > 1 || y + size.y > 1) return false;
      chart.at = {x + kMargin, y + kMargin};
      x += size.x;
    }
    return true;
  }

  void write(const std::vector<Chart>& charts, double scale) {
    MeshTopology& topology = mesh_.topology;
    topology.uvs.clear();
    topology.face_uvs.assign(faceCount(), glm::uvec3(0));
    for (const Chart& chart : charts) {
      std::map<uint32_t, uint32_t> known;
      for (const uint32_t f : chart.faces)
        for (int k = 0; k < 3; ++k) {
          const auto [it, fresh] = known.try_emplace(face(f)[k], uint32_t(topology.uvs.size()));
          topology.face_uvs[f][k] = it->second;
          if (!fresh) continue;
          const glm::dvec2 uv = chart.at + scale * (flat(f, k) - chart.min);
          topology.uvs.emplace_back(uv.x, 1 - uv.y);
        }
    }
  }

  RestMesh& mesh_;
  Neighbours neighbours_;
  std::vector<int> labels_;  // part * kDirections + direction
  std::vector<glm::dvec3> normals_;
  std::map<int, glm::dmat3> axes_;  // by part
};

}  // namespace

void unwrap(RestMesh& mesh, const std::function<int(const glm::vec3&)>& part) { Unwrapper(mesh, part).run(); }

}  // namespace fourdvt::studio

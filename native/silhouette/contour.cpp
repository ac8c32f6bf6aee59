// SPDX-License-Identifier: Apache-2.0
// Marching squares, the planar case of marching cubes. Source: William E. Lorensen, Harvey E. Cline: Marching Cubes: A
// High Resolution 3D Surface Construction Algorithm. Computer Graphics 21(4) (SIGGRAPH), 1987.
//
// Samples are pixel centres; a border of foreground samples surrounds the picture. A cell has corners 0…3 clockwise
// from the top left; its side k runs from corner k to corner k + 1.
#include "silhouette/contour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <queue>

#include "base/triangulate.h"

namespace fourdvt::silhouette {
namespace {

constexpr double kContourLevel = 127.5;
constexpr uint8_t kPerformer = 128;  // minimum value above the level
constexpr double kMinShare =
    0.02;  // minimum distance of a ring from a sample, as a share of a cell's side: keeps rings apart
constexpr int kCornerX[4] = {0, 1, 1, 0}, kCornerY[4] = {0, 0, 1, 1};
constexpr int kBeyondX[4] = {0, 1, 0, -1}, kBeyondY[4] = {-1, 0, 1, 0};  // neighbouring cell across side k

// True if eight samples are all foreground (`performer`) or all background.
bool sameForEight(const uint8_t* samples, bool performer) {
  constexpr uint64_t kTopBits = 0x8080808080808080;  // set for values >= kPerformer
  uint64_t eight;
  std::memcpy(&eight, samples, sizeof eight);
  return (eight & kTopBits) == (performer ? kTopBits : 0);
}

class Tracer {
 public:
  Tracer(const Image& coverage, int steps_per_px)
      : coverage_(coverage), steps_(steps_per_px), visited_(size_t(coverage.width + 1) * (coverage.height + 2), 0) {}

  std::vector<Ring> rings() {
    std::vector<Ring> all;
    for (int y = 0; y < coverage_.height; ++y) {
      const uint8_t* row = coverage_.at(0, y);
      bool before = true;  // foreground, as outside the picture
      for (int x = 0; x <= coverage_.width; ++x) {
        while (x + 8 <= coverage_.width && sameForEight(row + x, before)) x += 8;
        const bool here = x == coverage_.width || row[x] >= kPerformer;
        if (here != before && !visited(x - 1, y)) all.push_back(trace(x - 1, y));
        before = here;
      }
    }
    return all;
  }

 private:
  int sample(int x, int y) const {
    const bool inside = x >= 0 && y >= 0 && x < coverage_.width && y < coverage_.height;
    return inside ? *coverage_.at(x, y) : 255;
  }
  bool performer(int x, int y) const { return sample(x, y) >= kPerformer; }
  uint8_t& visited(int x, int y) { return visited_[size_t(y + 1) * (coverage_.width + 1) + x + 1]; }

  // Traces the ring through the side between samples (x, y) and (x + 1, y).
  Ring trace(int x, int y) {
    // The first cell is the one whose side, clockwise, runs from background to foreground.
    const bool below = !performer(x, y);
    int cell_y = below ? y : y - 1, cell_x = x, side = below ? 0 : 2;
    Ring ring;
    while (true) {
      if (side == 0 || side == 2) {
        uint8_t& seen = visited(cell_x, cell_y + (side == 2));
        if (seen) break;
        seen = 1;
      }
      ring.push_back(crossing(cell_x, cell_y, side));
      const int exit = exitOf(cell_x, cell_y, side);
      if (pictureCorner(cell_x, cell_y)) {
        const glm::dvec2 in = ring.back(), out = crossing(cell_x, cell_y, exit);
        ring.push_back(side % 2 == 0 ? glm::dvec2(in.x, out.y) : glm::dvec2(out.x, in.y));
      }
      cell_x += kBeyondX[exit];
      cell_y += kBeyondY[exit];
      side = (exit + 2) % 4;
    }
    return ring;
  }

  // True for cells in which a ring turns at a right angle, so that the picture's border stays straight.
  bool pictureCorner(int x, int y) const {
    return (x == -1 || x == coverage_.width - 1) && (y == -1 || y == coverage_.height - 1);
  }

  // Exit side of a ring that enters at side k, with background at corner k and foreground at corner k + 1.
  int exitOf(int x, int y, int entry) const {
    std::array<int, 4> value;
    for (int k = 0; k < 4; ++k) value[k] = sample(x + kCornerX[k], y + kCornerY[k]);
    const auto inside = [&](int k) { return value[k % 4] >= kPerformer; };
    const bool saddle = !inside(entry + 2) && inside(entry + 3);
    // Saddle: the cell's mean selects which two corners are connected.
    if (saddle && value[0] + value[1] + value[2] + value[3] > 4 * kContourLevel) return (entry + 3) % 4;
    int exit = entry + 1;
    while (inside(exit + 1)) ++exit;
    return exit % 4;
  }

  glm::dvec2 crossing(int x, int y, int side) const {
    const int next = (side + 1) % 4;
    const int x0 = x + kCornerX[side], y0 = y + kCornerY[side], x1 = x + kCornerX[next], y1 = y + kCornerY[next];
    const double v0 = sample(x0, y0), v1 = sample(x1, y1);
    const double share = crossingShare((kContourLevel - v0) / (v1 - v0));
    return {x0 + 0.5 + share * (x1 - x0), y0 + 0.5 + share * (y1 - y0)};
  }

  // Samples lie on multiples of the step, so that a crossing does where its share is a multiple.
  double crossingShare(double share) const {
    if (steps_ == 0) return std::clamp(share, kMinShare, 1 - kMinShare);
    return std::clamp(std::round(share * steps_), 1.0, steps_ - 1.0) / steps_;
  }

  const Image& coverage_;
  const int steps_;
  std::vector<uint8_t> visited_;  // sides between horizontal neighbours; every ring crosses at least one
};

}  // namespace

Outline outlineOf(const Image& coverage, const OutlineRules& rules) {
  if (coverage.empty() || coverage.channels != 1) return {};
  Outline outline{Tracer(coverage, rules.steps_per_px).rings()};
  std::erase_if(outline.rings, [&](const Ring& ring) {
    return ring.size() < 3 || std::abs(signedArea_px2(ring)) < rules.min_area_px2;
  });
  if (rules.tolerance_px > 0) simplifyRings(outline.rings, rules.tolerance_px);
  return outline;
}

namespace {

constexpr double kClearance_px = 0.01;  // minimum, between an edge and other vertices
constexpr double kStraight_px2 = 1e-9;  // twice the maximum area of a triangle that counts as straight
constexpr double kCell_px = 8;          // cell size of the vertex grid

double distanceSquared(const glm::dvec2& point, const glm::dvec2& from, const glm::dvec2& to) {
  const glm::dvec2 along = to - from, away = point - from;
  const double length2 = glm::dot(along, along);
  const double share = length2 > 0 ? std::clamp(glm::dot(away, along) / length2, 0.0, 1.0) : 0.0;
  const glm::dvec2 rest = away - share * along;
  return glm::dot(rest, rest);
}

struct Vertex {
  glm::dvec2 point{0};
  uint32_t ring = 0, previous = 0, next = 0;  // remaining vertices
  uint32_t version = 0;                       // incremented with changes of its neighbours
  bool stands = true;
};

struct Removal {
  double distance2 = 0;
  uint32_t vertex = 0, version = 0;
  bool operator<(const Removal& other) const {  // the minimum distance is on top of the queue; ties by index
    return distance2 != other.distance2 ? distance2 > other.distance2 : vertex > other.vertex;
  }
};

// Spatial hash of the vertices.
class Grid {
 public:
  explicit Grid(const std::vector<Vertex>& vertices) {
    if (vertices.empty()) return;
    glm::dvec2 high = low_ = vertices[0].point;
    for (const Vertex& v : vertices) low_ = glm::min(low_, v.point), high = glm::max(high, v.point);
    columns_ = int((high.x - low_.x) / kCell_px) + 1;
    rows_ = int((high.y - low_.y) / kCell_px) + 1;
    cells_.resize(size_t(columns_) * rows_);
    for (uint32_t v = 0; v < vertices.size(); ++v)
      cells_[size_t(cell(vertices[v].point.y - low_.y, rows_)) * columns_ +
             cell(vertices[v].point.x - low_.x, columns_)]
          .push_back(v);
  }

  // True if `holds` returns true for a vertex near the box.
  template <class Holds>
  bool any(const glm::dvec2& low, const glm::dvec2& high, const Holds& holds) const {
    const int x0 = cell(low.x - low_.x, columns_), x1 = cell(high.x - low_.x, columns_);
    const int y0 = cell(low.y - low_.y, rows_), y1 = cell(high.y - low_.y, rows_);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x)
        for (uint32_t v : cells_[size_t(y) * columns_ + x])
          if (holds(v)) return true;
    return false;
  }

 private:
  static int cell(double offset_px, int count) { return std::clamp(int(offset_px / kCell_px), 0, count - 1); }

  glm::dvec2 low_{0};
  int columns_ = 0, rows_ = 0;
  std::vector<std::vector<uint32_t>> cells_;
};

class Simplifier {
 public:
  Simplifier(const std::vector<Ring>& rings, double tolerance_px)
      : tolerance2_(tolerance_px * tolerance_px), vertices_(listed(rings)), grid_(vertices_) {
    uint32_t first = 0;
    for (const Ring& ring : rings) {
      first_.push_back(first);
      left_.push_back(uint32_t(ring.size()));
      first += uint32_t(ring.size());
    }
    first_.push_back(first);
  }

  void run() {
    for (bool changed = true; changed;) {  // repeated: a vertex that blocked a removal may have been removed
      changed = false;
      for (uint32_t v = 0; v < vertices_.size(); ++v) propose(v);
      while (!queue_.empty()) {
        const Removal removal = queue_.top();
        queue_.pop();
        const Vertex& v = vertices_[removal.vertex];
        if (!v.stands || v.version != removal.version || left_[v.ring] <= 3 || inTheWay(v)) continue;
        remove(removal.vertex);
        changed = true;
      }
    }
  }

  std::vector<Ring> rings() const {
    std::vector<Ring> out(left_.size());
    for (const Vertex& v : vertices_)
      if (v.stands) out[v.ring].push_back(v.point);
    return out;
  }

 private:
  static std::vector<Vertex> listed(const std::vector<Ring>& rings) {
    std::vector<Vertex> vertices;
    for (uint32_t r = 0; r < rings.size(); ++r) {
      const uint32_t first = uint32_t(vertices.size()), count = uint32_t(rings[r].size());
      for (uint32_t i = 0; i < count; ++i)
        vertices.push_back({rings[r][i], r, first + (i + count - 1) % count, first + (i + 1) % count});
    }
    return vertices;
  }

  // Queues the vertex for removal if the tolerance permits it.
  void propose(uint32_t index) {
    const Vertex& v = vertices_[index];
    if (!v.stands || left_[v.ring] <= 3) return;
    const glm::dvec2 &from = vertices_[v.previous].point, &to = vertices_[v.next].point;
    double farthest2 = 0;
    for (uint32_t i = given(v.previous, v.ring); i != v.next && farthest2 <= tolerance2_; i = given(i, v.ring))
      farthest2 = std::max(farthest2, distanceSquared(vertices_[i].point, from, to));
    if (farthest2 <= tolerance2_) queue_.push({farthest2, index, v.version});
  }

  // Next vertex of the input ring, removed or not.
  uint32_t given(uint32_t index, uint32_t ring) const {
    return index + 1 == first_[ring + 1] ? first_[ring] : index + 1;
  }

  // True if another vertex lies in the triangle with the neighbours, or within the clearance of the replacing edge.
  bool inTheWay(const Vertex& v) const {
    const glm::dvec2 &a = vertices_[v.previous].point, &b = v.point, &c = vertices_[v.next].point;
    const auto holds = [&](uint32_t index) {
      const Vertex& other = vertices_[index];
      if (!other.stands || &other == &v || index == v.previous || index == v.next) return false;
      const glm::dvec2& p = other.point;
      const double ab = cross(b - a, p - a), bc = cross(c - b, p - b), ca = cross(a - c, p - c);
      if ((ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0)) return true;
      return distanceSquared(p, a, c) < kClearance_px * kClearance_px;
    };
    return grid_.any(glm::min(a, glm::min(b, c)) - kClearance_px, glm::max(a, glm::max(b, c)) + kClearance_px, holds);
  }

  void remove(uint32_t index) {
    Vertex& v = vertices_[index];
    v.stands = false;
    --left_[v.ring];
    vertices_[v.previous].next = v.next;
    vertices_[v.next].previous = v.previous;
    for (uint32_t neighbour : {v.previous, v.next}) {
      ++vertices_[neighbour].version;
      propose(neighbour);
    }
  }

  double tolerance2_;
  std::vector<Vertex> vertices_;  // in the order of rings
  std::vector<uint32_t> first_;   // [ring] first vertex; the total at the end
  std::vector<uint32_t> left_;    // [ring] remaining vertices
  Grid grid_;
  std::priority_queue<Removal> queue_;
};

// Removes collinear points, so that simplification need not visit them.
void dropStraightPoints(Ring& ring) {
  Ring kept;
  for (size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2 &before = kept.empty() ? ring.back() : kept.back(), &after = ring[(i + 1) % ring.size()];
    if (std::abs(cross(ring[i] - before, after - ring[i])) > kStraight_px2) kept.push_back(ring[i]);
  }
  if (kept.size() >= 3) ring = std::move(kept);
}

}  // namespace

double signedArea_px2(const Ring& ring) {
  double twice = 0;
  for (size_t i = 0; i < ring.size(); ++i) twice += cross(ring[i], ring[(i + 1) % ring.size()]);
  return twice / 2;
}

void simplifyRings(std::vector<Ring>& rings, double tolerance_px) {
  for (Ring& ring : rings) dropStraightPoints(ring);
  Simplifier simplifier(rings, tolerance_px);
  simplifier.run();
  rings = simplifier.rings();
}

}  // namespace fourdvt::silhouette

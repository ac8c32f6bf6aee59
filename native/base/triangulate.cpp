// SPDX-License-Identifier: Apache-2.0
// Ear clipping. A hole is first joined to its polygon by a bridge, an edge traversed in both directions.
#include "base/triangulate.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fourdvt {
namespace {

// Twice the signed area; > 0: counter-clockwise.
double area(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) { return cross(b - a, c - a); }

double area(const FlatLoop& loop) {
  double twice = 0;
  for (size_t i = 0; i < loop.size(); ++i)
    twice += cross(loop[i].place - loop[0].place, loop[(i + 1) % loop.size()].place - loop[0].place);
  return twice;
}

bool contains(const FlatLoop& loop, const glm::dvec2& p) {
  bool inside = false;
  for (size_t i = 0; i < loop.size(); ++i) {
    const glm::dvec2 &a = loop[i].place, &b = loop[(i + 1) % loop.size()].place;
    if ((a.y > p.y) != (b.y > p.y) && (area(a, b, p) > 0) == (b.y > a.y)) inside = !inside;
  }
  return inside;
}

size_t rightmost(const FlatLoop& loop) {
  return size_t(std::max_element(loop.begin(), loop.end(),
                                 [](const FlatVertex& a, const FlatVertex& b) { return a.place.x < b.place.x; }) -
                loop.begin());
}

// Returns true if the segment from loop vertex i to p starts inside the polygon.
bool opensTo(const FlatLoop& loop, size_t i, const glm::dvec2& p) {
  const size_t n = loop.size();
  const glm::dvec2 &before = loop[(i + n - 1) % n].place, &at = loop[i].place, &after = loop[(i + 1) % n].place;
  const bool left_of_in = area(before, at, p) > 0, left_of_out = area(at, after, p) > 0;
  return area(before, at, after) > 0 ? left_of_in && left_of_out : left_of_in || left_of_out;
}

// Index of the outer vertex that a bridge from p reaches; p is the rightmost vertex of a hole.
size_t bridgeEnd(const FlatLoop& outer, const glm::dvec2& p) {
  const size_t n = outer.size();
  double nearest_x = std::numeric_limits<double>::infinity();
  size_t end = 0;
  for (size_t i = 0; i < n; ++i) {  // nearest edge to the right of p
    const glm::dvec2 &a = outer[i].place, &b = outer[(i + 1) % n].place;
    if (!(a.y <= p.y && b.y > p.y)) continue;
    const double x = a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
    if (x < p.x || x >= nearest_x) continue;
    nearest_x = x;
    end = a.x > b.x ? i : (i + 1) % n;
  }
  if (!std::isfinite(nearest_x)) return 0;
  // Vertices between p, that edge and its end may occlude the end; the one at the flattest angle is visible.
  const glm::dvec2 hit(nearest_x, p.y), corner = outer[end].place;
  const double turn = area(p, hit, corner) > 0 ? 1 : -1;
  double flattest = std::numeric_limits<double>::infinity();
  size_t best = end;
  for (size_t i = 0; i < n; ++i) {
    const glm::dvec2& q = outer[i].place;
    const bool within =
        turn * area(p, hit, q) >= 0 && turn * area(hit, corner, q) >= 0 && turn * area(corner, p, q) >= 0;
    if (q.x < p.x || !within || !opensTo(outer, i, p)) continue;
    const double angle = std::abs(q.y - p.y) / std::max(q.x - p.x, 1e-300);
    if (angle < flattest) flattest = angle, best = i;
  }
  return best;
}

void bridge(FlatLoop& outer, const FlatLoop& hole) {
  const size_t from = rightmost(hole), to = bridgeEnd(outer, hole[from].place);
  FlatLoop way(hole.begin() + ptrdiff_t(from), hole.end());
  way.insert(way.end(), hole.begin(), hole.begin() + ptrdiff_t(from) + 1);
  way.push_back(outer[to]);
  outer.insert(outer.begin() + ptrdiff_t(to) + 1, way.begin(), way.end());
}

class EarClipper {
 public:
  EarClipper(const FlatLoop& loop, std::vector<glm::uvec3>& triangles) : loop_(loop), triangles_(triangles) {
    const uint32_t n = uint32_t(loop.size());
    for (uint32_t i = 0; i < n; ++i) links_.push_back({(i + n - 1) % n, (i + 1) % n, 0});
  }

  void run() {
    uint32_t left = uint32_t(loop_.size()), at = 0;
    for (uint32_t i = 0; i < left; ++i) links_[i].quality = quality(i);
    for (; left > 3; --left) {
      uint32_t best = at;
      for (uint32_t i = links_[at].next; i != at; i = links_[i].next)
        if (links_[i].quality > links_[best].quality) best = i;
      clip(best);
      at = links_[best].next;
      links_[at].quality = quality(at);
      links_[links_[at].previous].quality = quality(links_[at].previous);
    }
    if (left == 3) emit(at);
  }

 private:
  struct Link {
    uint32_t previous = 0, next = 0;
    double quality = 0;  // ear quality: area over squared length; <= 0: no ear
  };

  double quality(uint32_t i) const {
    const FlatVertex &a = loop_[links_[i].previous], &b = loop_[i], &c = loop_[links_[i].next];
    const double twice = area(a.place, b.place, c.place);
    const glm::dvec2 ab = b.place - a.place, bc = c.place - b.place, ca = a.place - c.place;
    const double longest2 = std::max({glm::dot(ab, ab), glm::dot(bc, bc), glm::dot(ca, ca), 1e-300});
    if (a.id == c.id) return -2;  // bridge end: degenerate
    if (twice <= 0) return twice / longest2 - 1;
    for (uint32_t k = links_[links_[i].next].next; k != links_[i].previous; k = links_[k].next) {
      const FlatVertex& p = loop_[k];
      if (p.id == a.id || p.id == b.id || p.id == c.id) continue;
      if (area(a.place, b.place, p.place) >= 0 && area(b.place, c.place, p.place) >= 0 &&
          area(c.place, a.place, p.place) >= 0)
        return -1;
    }
    return twice / longest2;
  }

  void emit(uint32_t i) {
    triangles_.emplace_back(loop_[links_[i].previous].id, loop_[i].id, loop_[links_[i].next].id);
  }
  void clip(uint32_t i) {
    emit(i);
    links_[links_[i].previous].next = links_[i].next;
    links_[links_[i].next].previous = links_[i].previous;
  }

  const FlatLoop& loop_;
  std::vector<glm::uvec3>& triangles_;
  std::vector<Link> links_;
};

}  // namespace

void triangulate(std::vector<FlatLoop> loops, std::vector<glm::uvec3>& triangles) {
  if (loops.size() == 1) return EarClipper(loops[0], triangles).run();
  std::vector<FlatLoop> outers, holes;
  std::vector<double> areas;  // areas, outer loops only
  for (FlatLoop& loop : loops) (area(loop) > 0 ? outers : holes).push_back(std::move(loop));
  for (const FlatLoop& outer : outers) areas.push_back(area(outer));
  const std::vector<FlatLoop> given = outers;
  std::sort(holes.begin(), holes.end(),
            [](const FlatLoop& a, const FlatLoop& b) { return a[rightmost(a)].place.x > b[rightmost(b)].place.x; });
  for (const FlatLoop& hole : holes) {
    size_t home = outers.size();
    for (size_t o = 0; o < given.size(); ++o)
      if ((home == outers.size() || areas[o] < areas[home]) && contains(given[o], hole[0].place)) home = o;
    if (home < outers.size())
      bridge(outers[home], hole);
    else
      EarClipper(hole, triangles).run();  // sliver inverted by rounding
  }
  for (const FlatLoop& outer : outers) EarClipper(outer, triangles).run();
}

}  // namespace fourdvt

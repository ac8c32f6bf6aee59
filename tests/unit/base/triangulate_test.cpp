// SPDX-License-Identifier: Apache-2.0
#include "base/triangulate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

namespace fourdvt {
namespace {

FlatLoop loop(const std::vector<glm::dvec2>& places, uint32_t first_id) {
  FlatLoop out;
  for (const glm::dvec2& p : places) out.push_back({p, first_id++});
  return out;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// Expects triangles that cover the loops' area with positive orientation, and leave exactly the loops' edges open.
void expectCovered(const std::vector<FlatLoop>& loops) {
  std::map<uint32_t, glm::dvec2> places;
  std::map<std::pair<uint32_t, uint32_t>, int> open;
  double twice = 0;
  for (const FlatLoop& l : loops)
    for (size_t i = 0; i < l.size(); ++i) {
      const FlatVertex &a = l[i], &b = l[(i + 1) % l.size()];
      places[a.id] = a.place;
      ++open[{a.id, b.id}];
      twice += cross(a.place, b.place);
    }
  std::vector<glm::uvec3> triangles;
  triangulate(loops, triangles);
  double covered = 0;
  for (const glm::uvec3& t : triangles) {
    const double area = cross(places[t.y] - places[t.x], places[t.z] - places[t.x]);
    EXPECT_GE(area, -1e-12);
    covered += area;
    for (int k = 0; k < 3; ++k) {
      --open[{t[k], t[(k + 1) % 3]}];
      ++open[{t[(k + 1) % 3], t[k]}];
    }
  }
  EXPECT_NEAR(covered, twice, 1e-9);
  // Inner edges cancel. A loop's edge leaves its opposite, which the neighbouring face supplies.
  int left = 0;
  for (const auto& [edge, count] : open) left += count != 0;
  size_t edges = 0;
  for (const FlatLoop& l : loops) edges += l.size();
  EXPECT_EQ(left, int(edges));
}

const std::vector<glm::dvec2> kOuterSquare{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
std::vector<glm::dvec2> hole(double x, double y) { return {{x, y}, {x + .1, y + 1}, {x + 1, y + 1.1}, {x + 1.2, y}}; }

TEST(Triangulate, ConvexAndReflexLoops) {
  expectCovered({loop({{0, 0}, {1, 0}, {0, 1}}, 0)});
  expectCovered({loop(kOuterSquare, 0)});
  expectCovered({loop({{0, 0}, {4, 0}, {4, 4}, {3, 4}, {3, 1}, {2, 1.5}, {1, 1}, {1, 4}, {0, 4}}, 0)});
}

TEST(Triangulate, HolesAreJoined) {
  expectCovered({loop(kOuterSquare, 0), loop(hole(4, 4), 10)});
  expectCovered({loop(kOuterSquare, 0), loop(hole(1, 4), 10), loop(hole(4, 4.3), 20), loop(hole(7, 4.1), 30)});
  expectCovered({loop(hole(4, 1), 10), loop(kOuterSquare, 0), loop(hole(4.2, 7), 20), loop(hole(4.1, 4), 30)});
}

TEST(Triangulate, SeveralPolygonsKeepTheirHoles) {
  std::vector<glm::dvec2> other = kOuterSquare;
  for (glm::dvec2& p : other) p.x += 20;
  expectCovered(
      {loop(kOuterSquare, 0), loop(other, 10), loop(hole(4, 4), 20), loop(hole(24, 4), 30), loop(hole(26, 7), 40)});
}

TEST(Triangulate, IslandInAHoleKeepsItsOwnHole) {
  const std::vector<glm::dvec2> pond{{1, 1}, {1, 9}, {9, 9}, {9, 1}}, island{{3, 3}, {7, 3}, {7, 7}, {3, 7}};
  expectCovered({loop(kOuterSquare, 0), loop(pond, 10), loop(island, 20), loop(hole(4.5, 4.5), 30)});
  expectCovered({loop(island, 20), loop(hole(4.5, 4.5), 30), loop(pond, 10), loop(kOuterSquare, 0)});
}

TEST(Triangulate, RandomStarsWithHoles) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> radius(3, 10), small(0.1, 0.4);
  for (int round = 0; round < 200; ++round) {
    const int n = 5 + round % 60;
    std::vector<glm::dvec2> star;
    for (int i = 0; i < n; ++i) {
      const double angle = 6.2831853 * i / n;
      star.push_back(radius(random) * glm::dvec2(std::cos(angle), std::sin(angle)));
    }
    std::vector<FlatLoop> loops{loop(star, 0)};
    for (int h = 0; h < round % 5; ++h) {
      std::vector<glm::dvec2> ring;
      const glm::dvec2 centre(-1.2 + 0.6 * h, 0.2 * (h % 2));
      for (int i = 0; i < 6; ++i)
        ring.push_back(centre + small(random) * 0.7 * glm::dvec2(std::cos(-1.047 * i), std::sin(-1.047 * i)));
      loops.push_back(loop(ring, uint32_t(1000 + 100 * h)));
    }
    expectCovered(loops);
  }
}

TEST(Triangulate, LoopThatRoundingTurnedOverStillClosesTheSurface) {
  std::vector<glm::uvec3> triangles;
  triangulate({loop({{0, 0}, {0, 1e-16}, {1, 0}, {0.5, -1e-17}}, 0)}, triangles);
  EXPECT_EQ(triangles.size(), 2u);
  triangulate({loop(kOuterSquare, 10), loop({{20, 0}, {20, 1e-9}, {21, 0}}, 20)},
              triangles);  // clockwise, inside no other loop
  EXPECT_EQ(triangles.size(), 5u);
}

}  // namespace
}  // namespace fourdvt

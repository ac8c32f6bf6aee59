// SPDX-License-Identifier: Apache-2.0
#include "capture/polygon.h"

#include <gtest/gtest.h>

#include "capture/mesh_file.h"
#include "capture_fixture.h"

namespace fourdvt::capture {
namespace {

using Corners = std::vector<glm::vec3>;
using Triangles = std::vector<glm::uvec3>;

Triangles split(const Corners& corners) {
  Triangles out;
  EXPECT_TRUE(splitPolygon(corners, out));
  EXPECT_EQ(out.size(), corners.size() - 2);
  return out;
}

glm::dvec3 areaOf(const Corners& p, const glm::uvec3& t) {
  return 0.5 * glm::cross(glm::dvec3(p[t.y] - p[t.x]), glm::dvec3(p[t.z] - p[t.x]));
}

// Expects triangles that cover the polygon once: none reversed, and their areas sum up to its own.
void expectCovered(const Corners& corners, const Triangles& triangles, double area) {
  glm::dvec3 sum(0);
  for (const glm::uvec3& t : triangles) sum += areaOf(corners, t);
  EXPECT_NEAR(glm::length(sum), area, 1e-4 * area);
  double covered = 0;
  for (const glm::uvec3& t : triangles) {
    EXPECT_GE(glm::dot(areaOf(corners, t), sum), -1e-9);
    covered += glm::length(areaOf(corners, t));
  }
  EXPECT_NEAR(covered, area, 1e-4 * area);
}

Corners begunAt(Corners corners, size_t first) {
  std::rotate(corners.begin(), corners.begin() + long(first), corners.end());
  return corners;
}

const Corners kL{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};

TEST(Polygon, ConvexOnesAreFans) {
  EXPECT_EQ(split({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}), (Triangles{{0, 1, 2}}));
  EXPECT_EQ(split({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}), (Triangles{{0, 1, 2}, {0, 2, 3}}));
  Corners ring;
  for (int i = 0; i < 9000; ++i) ring.emplace_back(3, std::cos(i * 2 * M_PI / 9000), std::sin(i * 2 * M_PI / 9000));
  const Triangles fan = split(ring);
  for (uint32_t i = 0; i < fan.size(); ++i) ASSERT_EQ(fan[i], glm::uvec3(0, i + 1, i + 2));
}

// Collinear and repeated corners, sides that leave the plane: triangulated as a fan.
TEST(Polygon, NearlyConvexOnesAreFans) {
  for (const Corners& corners :
       {Corners{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}},
        Corners{{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1, 0}}, Corners{{0, 0, 0.2f}, {1, 0, 0}, {1, 1, 0.2f}, {0, 1, 0}},
        Corners{{1e6f, 0, 0}, {1e6f + 1, 0, 0}, {1e6f + 1, 1, 0}, {1e6f, 1, 0}}})
    for (const glm::uvec3& t : split(corners)) EXPECT_EQ(t.x, 0u);
}

// From any first corner, in any plane.
TEST(Polygon, ConcaveOnesAreCoveredOnce) {
  for (size_t first = 0; first < kL.size(); ++first) {
    for (const glm::vec3& scale : {glm::vec3(1), glm::vec3(-1, 1, 1), glm::vec3(1e-3f), glm::vec3(1e3f)}) {
      Corners corners = begunAt(kL, first);
      for (glm::vec3& p : corners) {
        p *= scale;
        p = glm::vec3(0.6f * p.x + 5, p.y, 0.8f * p.x - 2);
      }
      expectCovered(corners, split(corners), 3.0 * scale.y * scale.y);
    }
  }
  Corners dart{{0, 0, 0}, {1, 2, 0}, {0, 0.5f, 0}, {-1, 2, 0}};
  EXPECT_EQ(split(begunAt(dart, 1)), (Triangles{{3, 0, 1}, {3, 1, 2}})) << "the other diagonal";
}

// A square with a square hole: the cut to the hole is traversed in both directions.
TEST(Polygon, ACutMayLeadToAHole) {
  const Corners corners{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0},
                        {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};
  for (size_t first = 0; first < corners.size(); ++first) {
    const Corners begun = begunAt(corners, first);
    expectCovered(begun, split(begun), 12);
  }
}

// Invalid polygons: every corner is used, without a crash.
TEST(Polygon, CrossingAndFlatOnesAreFans) {
  const float nan = NAN;
  for (const Corners& corners :
       {Corners{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1.5f, 0}}, Corners{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 0, 0}},
        Corners{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, Corners{{0, 0, nan}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
        Corners{{0, 1, 0}, {.59f, -.81f, 0}, {-.95f, .31f, 0}, {.95f, .31f, 0}, {-.59f, -.81f, 0}}})
    for (const glm::uvec3& t : split(corners)) EXPECT_EQ(t.x, 0u);
}

TEST(Polygon, OfTooManyCornersToClip) {
  Corners saw;
  for (int i = 0; i < 5000; ++i) saw.emplace_back(i, i % 2 == 0 ? 0 : 5, 0);
  saw.emplace_back(2500, 9000, 0);
  Triangles out;
  EXPECT_FALSE(splitPolygon(saw, out));
  EXPECT_TRUE(out.empty());
  std::string text, face = "f";
  for (size_t i = 0; i < saw.size(); ++i) {
    text += "v " + std::to_string(saw[i].x) + " " + std::to_string(saw[i].y) + " 0\n";
    face += " " + std::to_string(i + 1);
  }
  expectError(parseMesh(text + face + "\n", "a.obj"), ErrorId::Unsupported, "a.obj:5002: ");
}

}  // namespace
}  // namespace fourdvt::capture

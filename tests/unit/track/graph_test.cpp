// SPDX-License-Identifier: Apache-2.0
// Deformation graph on a tube, whose motions are known.
#include "track/graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

namespace fourdvt::track {
namespace {

constexpr int kAround = 16, kAlong = 41;
constexpr double kLength_m = 1, kRadius_m = 0.08;

struct Tube {
  std::vector<glm::uvec3> faces;
  Positions positions;
  Tube() {
    for (int i = 0; i < kAlong; ++i)
      for (int k = 0; k < kAround; ++k) {
        const double angle = 2 * glm::pi<double>() * k / kAround;
        positions.emplace_back(kRadius_m * std::cos(angle), kLength_m * i / (kAlong - 1), kRadius_m * std::sin(angle));
      }
    for (uint32_t i = 0; i + 1 < kAlong; ++i)
      for (uint32_t k = 0; k < kAround; ++k) {
        const uint32_t a = i * kAround + k, b = i * kAround + (k + 1) % kAround, c = a + kAround, d = b + kAround;
        faces.emplace_back(a, c, b);
        faces.emplace_back(b, c, d);
      }
  }
};

struct GraphTest : ::testing::Test {
  Tube tube;
  DeformationGraph graph = makeGraph(tube.faces, tube.positions, 24);
  std::vector<glm::vec3> nodes = [this] {
    std::vector<glm::vec3> out;
    for (const uint32_t v : graph.nodes) out.push_back(tube.positions[v]);
    return out;
  }();
  GraphPose pose = GraphPose::identity(graph.nodes.size());

  Positions posed() const { return deformed(graph, nodes, tube.positions, pose); }

  // Fits all three coordinates of the vertices for which `is_seen`.
  template <class Seen>
  void fit(const Positions& target, const Seen& is_seen, int steps, double rigidity) {
    for (int step = 0; step < steps; ++step) {
      const Positions now = posed();
      std::vector<Pull> pulls(now.size());
      for (size_t v = 0; v < now.size(); ++v)
        for (int axis = 0; axis < 3 && is_seen(v); ++axis) {
          glm::dvec3 direction(0);
          direction[axis] = 1;
          pulls[v].add(direction, double(target[v][axis]) - double(now[v][axis]), 1);
        }
      fitGraph(graph, nodes, tube.positions, pulls, {rigidity, 1e-9}, pose);
    }
  }
};

double largestDistance(const Positions& a, const Positions& b) {
  double out = 0;
  for (size_t v = 0; v < a.size(); ++v) out = std::max(out, double(glm::distance(a[v], b[v])));
  return out;
}

TEST_F(GraphTest, InfluencesFormAPartitionOfUnity) {
  EXPECT_EQ(graph.nodes.size(), 24u);
  for (const auto& influences : graph.influences) {
    double sum = 0;
    for (const auto& [node, weight] : influences) {
      EXPECT_GE(weight, 0);
      EXPECT_LT(node, graph.nodes.size());
      sum += weight;
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
  EXPECT_LT(largestDistance(posed(), tube.positions), 1e-6);
}

TEST_F(GraphTest, RigidMotionIsFoundExactly) {
  const double turn = 0.7;
  Positions target;
  for (const glm::vec3& p : tube.positions)
    target.emplace_back(std::cos(turn) * p.x - std::sin(turn) * p.y + 0.2, std::sin(turn) * p.x + std::cos(turn) * p.y,
                        p.z - 0.1);
  fit(
      target, [](size_t) { return true; }, 12, 1);
  EXPECT_LT(largestDistance(posed(), target), 1e-4);
}

// The hidden half has no data: rigidity takes it along.
TEST_F(GraphTest, HiddenVerticesFollowTheirNeighbours) {
  Positions target;
  for (const glm::vec3& p : tube.positions) target.push_back(p + glm::vec3(0.1f, -0.05f, 0.2f));
  fit(
      target, [&](size_t v) { return tube.positions[v].y < 0.5f; }, 8, 0.1);
  EXPECT_LT(largestDistance(posed(), target), 1e-3);
}

TEST_F(GraphTest, BendIsFollowed) {
  Positions target;  // onto an arc of 90°
  const double radius = kLength_m / (glm::pi<double>() / 2);
  for (const glm::vec3& p : tube.positions) {
    const double angle = p.y / radius;
    target.emplace_back(radius - (radius - p.x) * std::cos(angle), (radius - p.x) * std::sin(angle), p.z);
  }
  fit(
      target, [](size_t) { return true; }, 20, 1e-3);
  EXPECT_LT(largestDistance(posed(), target), 0.012);
}

// Two strands that touch: nodes of one do not move the other.
TEST(DeformationGraph, InfluencesFollowTheSurface) {
  Tube tube;
  const auto count = uint32_t(tube.positions.size()), faces = uint32_t(tube.faces.size());
  for (uint32_t v = 0; v < count; ++v)
    tube.positions.push_back(tube.positions[v] + glm::vec3(2 * float(kRadius_m), 0, 0));
  for (uint32_t f = 0; f < faces; ++f) tube.faces.push_back(tube.faces[f] + count);
  const DeformationGraph graph = makeGraph(tube.faces, tube.positions, 40);
  for (size_t v = 0; v < tube.positions.size(); ++v)
    for (const auto& [node, weight] : graph.influences[v])
      if (weight > 1e-6) {
        EXPECT_EQ(graph.nodes[node] < count, v < count);
      }
}

TEST(FitVertices, SpreadsWhatIsSeenOverTheNeighbours) {
  const Tube tube;
  const std::vector<glm::uvec2> edges = edgesOf(tube.faces);
  std::vector<Pull> pulls(tube.positions.size());
  for (size_t v = 0; v < pulls.size(); v += 7) pulls[v].add({1, 0, 0}, 0.01, 1);
  for (const glm::dvec3& d : fitVertices(edges, pulls, {10, 0})) {
    EXPECT_NEAR(d.x, 0.01, 1e-4);
    EXPECT_NEAR(d.y, 0, 1e-6);
  }
}

TEST(EdgesOf, ListsEveryEdgeOnce) {
  const std::vector<glm::uvec3> faces{{0, 1, 2}, {2, 1, 3}};
  EXPECT_EQ(edgesOf(faces).size(), 5u);
}

}  // namespace
}  // namespace fourdvt::track

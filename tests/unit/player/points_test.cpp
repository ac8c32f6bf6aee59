// SPDX-License-Identifier: Apache-2.0
// Points on the shown surface, as used for a page's hotspots.
#include "player_edge.h"

using namespace fourdvt;
using namespace fourdvt::testing;

TEST(PlayerPoints, AVertexIsWhereItIsShownAndIsFoundAgainThere) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 28, 10, 25, true, 192, 16}});
  SimulatedEdge edge(character, {});
  EXPECT_FALSE(edge.player->surfacePoint(0)) << "nothing is shown";
  ASSERT_TRUE(edge.load());
  ASSERT_TRUE(edge.runUntilShown());
  const uint32_t count = edge.player->mesh()->topology.vertex_count;
  ASSERT_GT(count, 3u);
  EXPECT_FALSE(edge.player->surfacePoint(count));
  int same = 0, seen = 0;
  for (uint32_t vertex = 0; vertex < count; ++vertex) {
    const auto point = edge.player->surfacePoint(vertex);
    ASSERT_TRUE(point);
    if (!(glm::length(point->normal) > 0)) continue;
    const glm::dvec3 away = glm::normalize(point->normal);
    const double azimuth = glm::degrees(std::atan2(away.x, away.z)), elevation = glm::degrees(std::asin(away.y));
    // Beside the vertex, whose own pixel may fall between two faces.
    for (const double azimuth_step : {-8.0, 0.0, 8.0}) {
      const OrbitView view{azimuth + azimuth_step, glm::clamp(elevation, -80.0, 80.0), 3, point->position, 35};
      const PinholeCamera camera = cameraFromOrbit(view, 400, 300);
      const glm::dvec3 pixel = camera.project(point->position);
      EXPECT_NEAR(pixel.x, 200, 1e-3);
      EXPECT_NEAR(pixel.y, 150, 1e-3);
      for (const double dx : {-0.05, 0.05})
        for (const double dy : {-0.05, 0.05}) {
          const auto found = edge.player->vertexAt(camera, pixel.x + dx, pixel.y + dy);
          if (!found) continue;
          ++seen;
          same += *found == vertex;
          const auto nearer = edge.player->surfacePoint(*found);
          EXPECT_LE(camera.project(nearer->position).z, pixel.z + 1) << "nothing behind it is taken";
        }
      EXPECT_FALSE(edge.player->vertexAt(camera, -4000, 0));
    }
  }
  EXPECT_GT(seen, 0);
  EXPECT_GT(same, seen / 2) << same << " of " << seen;
}

TEST(PlayerPoints, TheyMoveWithTheCharacter) {
  const FakeCharacter character = FakeBuilder().build({{"walk", 28, 10, 25, true, 192, 16}});
  SimulatedEdge edge(character, {});
  ASSERT_TRUE(edge.load());
  ASSERT_TRUE(edge.runUntilShown());
  const auto before = edge.player->surfacePoint(1);
  edge.player->setPlacement({{2, -1}, 0});
  const auto after = edge.player->surfacePoint(1);
  ASSERT_TRUE(before && after);
  EXPECT_NEAR(after->position.x - before->position.x, 2, 1e-5);
  EXPECT_NEAR(after->position.y - before->position.y, 0, 1e-5);
  EXPECT_NEAR(after->position.z - before->position.z, -1, 1e-5);
}

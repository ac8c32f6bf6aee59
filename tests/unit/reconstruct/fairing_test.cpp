// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "reconstruct/carve.h"
#include "reconstruct/surface_cleaning.h"
#include "silhouette_fixture.h"

namespace fourdvt::reconstruct {
namespace {

struct FairingTest : ::testing::Test {
  std::vector<silhouette::Silhouette> silhouettes = Rig(ringCameras(5), ballShape({0, 0, 0}, 0.4)).silhouettes();
  std::vector<CarvingView> views;
  TriangleMesh hull;
  void SetUp() override {
    for (const silhouette::Silhouette& s : silhouettes)
      views.push_back({&s, silhouette::SilhouetteDistance(s.coverage)});
    auto made = volumetricHull(views, {0.02, 0});
    ASSERT_TRUE(made.ok());
    hull = std::move(made.value().mesh);
  }
  // Distance of the ridges from the sphere that the silhouettes show: 98th percentile of the vertices.
  static double off(const TriangleMesh& mesh) {
    std::vector<double> all;
    for (const glm::vec3& p : mesh.positions) all.push_back(glm::length(p) - 0.4);
    std::nth_element(all.begin(), all.begin() + long(all.size() * 98 / 100), all.end());
    return all[all.size() * 98 / 100];
  }
};

TEST_F(FairingTest, RidgesComeCloserToTheShape) {
  TriangleMesh faired = hull;
  EXPECT_EQ(fairSurface(faired, views, 20, [](const TriangleMesh&) { return true; }), 20);
  EXPECT_LT(off(faired), off(hull));
  EXPECT_GT(off(faired), 0);
}

TEST_F(FairingTest, NothingLeavesTheSilhouettes) {
  TriangleMesh faired = hull;
  fairSurface(faired, views, 20, [](const TriangleMesh&) { return true; });
  for (size_t v = 0; v < hull.positions.size(); ++v)
    for (const CarvingView& view : views) {
      const auto clear = [&](const glm::vec3& p) {
        const glm::dvec3 q = view.silhouette->camera.project(glm::dvec3(p));
        return view.distance.at(q.x, q.y);
      };
      EXPECT_GE(clear(faired.positions[v]), std::min(-0.26f, clear(hull.positions[v]) - 0.01f));
    }
}

TEST_F(FairingTest, ARoundThatIsTooMuchIsTakenBack) {
  TriangleMesh faired = hull;
  int asked = 0;
  EXPECT_EQ(fairSurface(faired, views, 10, [&](const TriangleMesh&) { return ++asked < 3; }), 2);
  TriangleMesh two = hull;
  fairSurface(two, views, 2, [](const TriangleMesh&) { return true; });
  EXPECT_EQ(faired.positions, two.positions);
}

}  // namespace
}  // namespace fourdvt::reconstruct

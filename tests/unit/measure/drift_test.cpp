// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/drift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>

namespace fourdvt::measure {
namespace {

// Grid of n × n squares over [from, from + side]², raised to y = height(x, z); faces upwards.
TriangleMesh sheet(int n, double from, double side, const std::function<double(double, double)>& height) {
  TriangleMesh mesh;
  for (int i = 0; i <= n; ++i)
    for (int k = 0; k <= n; ++k) {
      const double x = from + side * i / n, z = from + side * k / n;
      mesh.positions.emplace_back(x, height(x, z), z);
    }
  const auto at = [&](int i, int k) { return uint32_t(i * (n + 1) + k); };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      mesh.faces.push_back({at(i, k), at(i, k + 1), at(i + 1, k)});
      mesh.faces.push_back({at(i + 1, k), at(i, k + 1), at(i + 1, k + 1)});
    }
  return mesh;
}

TriangleMesh flat(int n, double from, double side, double y) {
  return sheet(n, from, side, [=](double, double) { return y; });
}

Positions moved(const Positions& positions, const glm::dmat4& by) {
  Positions out;
  for (const glm::vec3& p : positions) out.emplace_back(by * glm::dvec4(p, 1));
  return out;
}

Positions shifted(const Positions& positions, const glm::dvec3& by) {
  return moved(positions, glm::translate(glm::dmat4(1), by));
}

glm::dmat4 turn(double angle) { return glm::rotate(glm::dmat4(1), angle, glm::normalize(glm::dvec3(1, 2, 3))); }

TEST(Drift, RigidMotionHasNone) {
  const TriangleMesh reference =
      sheet(20, 0, 1, [](double x, double z) { return 0.1 * std::sin(5 * x) * std::cos(4 * z); });
  const TriangleMesh tracked = sheet(13, 0.1, 0.8, [](double x, double z) {
    return 0.1 * std::sin(5 * x) * std::cos(4 * z) + 0.004 * std::sin(40 * x);
  });
  const SurfaceBinding binding(tracked, reference);
  ASSERT_EQ(binding.vertices().size(), tracked.positions.size());
  const glm::dmat4 motion = glm::translate(glm::dmat4(1), glm::dvec3(0.3, -0.2, 1)) * turn(1.1);
  for (const glm::dmat4& by : {glm::dmat4(1), motion})
    for (const glm::dvec3& error : binding.errors(moved(tracked.positions, by), moved(reference.positions, by)))
      EXPECT_LT(glm::length(error), 1e-6);
}

TEST(Drift, SlideAlongAPlaneIsTangential) {
  const TriangleMesh reference = flat(8, 0, 1, 0), tracked = flat(5, 0.2, 0.5, 0.003);
  const SurfaceBinding binding(tracked, reference);
  ASSERT_EQ(binding.vertices().size(), 36u);
  DriftSamples samples;
  samples.add(binding.errors(shifted(tracked.positions, {0.003, 0, -0.004}), reference.positions));
  const DriftFigures figures = samples.figures();
  EXPECT_NEAR(figures.tangential_mean_m, 0.005, 1e-6);
  EXPECT_NEAR(figures.normal_mean_m, 0, 1e-6);
  EXPECT_NEAR(figures.mean_m, 0.005, 1e-6);
  EXPECT_NEAR(figures.max_m, 0.005, 1e-6);
}

TEST(Drift, LiftOffAPlaneIsNormal) {
  const TriangleMesh reference = flat(8, 0, 1, 0), tracked = flat(5, 0.2, 0.5, -0.003);
  const SurfaceBinding binding(tracked, reference);
  const glm::dmat4 by = turn(0.7);
  DriftSamples samples;
  samples.add(binding.errors(moved(shifted(tracked.positions, {0, 0.002, 0}), by), moved(reference.positions, by)));
  EXPECT_NEAR(samples.figures().normal_mean_m, 0.002, 1e-6);
  EXPECT_NEAR(samples.figures().tangential_mean_m, 0, 1e-6);
}

// A stretched surface carries its points along: a mesh that stays behind has an error.
TEST(Drift, FollowsTheSurfaceAsItStretches) {
  const TriangleMesh reference = flat(8, 0, 1, 0), tracked = flat(5, 0.2, 0.5, 0);
  const SurfaceBinding binding(tracked, reference);
  const glm::dmat4 stretch = glm::scale(glm::dmat4(1), glm::dvec3(1.1, 1, 1));
  const auto follows = binding.errors(moved(tracked.positions, stretch), moved(reference.positions, stretch));
  const auto stays = binding.errors(tracked.positions, moved(reference.positions, stretch));
  for (size_t i = 0; i < follows.size(); ++i) {
    EXPECT_LT(glm::length(follows[i]), 1e-6);
    EXPECT_NEAR(glm::length(stays[i]), 0.1 * tracked.positions[binding.vertices()[i]].x, 1e-6);
  }
}

TEST(Drift, LeavesOutWhatIsFarOrFacesAway) {
  const TriangleMesh reference = flat(8, 0, 1, 0);
  const SurfaceBinding far(flat(2, 0.2, 0.5, 0.02), reference);
  EXPECT_EQ(far.vertices().size(), 0u);
  EXPECT_EQ(far.far(), 9u);
  EXPECT_EQ(SurfaceBinding(flat(2, 0.2, 0.5, 0.02), reference, {.within_m = 0.03}).vertices().size(), 9u);
  TriangleMesh turned = flat(2, 0.2, 0.5, 0.001);
  for (glm::uvec3& face : turned.faces) std::swap(face.y, face.z);
  const SurfaceBinding away(turned, reference);
  EXPECT_EQ(away.vertices().size(), 0u);
  EXPECT_EQ(away.facingAway(), 9u);
}

// An error that turns with the surface does not change; one that jumps by 6 mm does.
TEST(Drift, ChangeIsMeasuredInTheAxesOfTheSurface) {
  const TriangleMesh reference = flat(8, 0, 1, 0), tracked = flat(5, 0.2, 0.5, 0.003);
  const SurfaceBinding binding(tracked, reference);
  const Positions slid = shifted(tracked.positions, {0.003, 0.001, 0}),
                  back = shifted(tracked.positions, {-0.003, 0.001, 0});
  const auto errors = binding.errors(slid, reference.positions);
  const auto turned = binding.errors(moved(slid, turn(0.9)), moved(reference.positions, turn(0.9)));
  const auto jumped = binding.errors(moved(back, turn(0.9)), moved(reference.positions, turn(0.9)));
  EXPECT_NEAR(errorChange_m(errors, turned), 0, 1e-6);
  EXPECT_NEAR(errorChange_m(errors, jumped), 0.006, 1e-6);
}

TEST(Drift, FiguresAreThoseOfAllVerticesAndFrames) {
  DriftSamples first, second;
  for (int i = 0; i <= 99; ++i) first.add({{1e-3 * i, 0, 0}});
  second.add({{0, 0, -0.1}});
  first.addChange(0.001);
  second.addChange(0.003);
  first.add(second);
  const DriftFigures figures = first.figures();
  EXPECT_NEAR(figures.mean_m, 0.05, 1e-9);
  EXPECT_NEAR(figures.median_m, 0.05, 1e-9);
  EXPECT_NEAR(figures.p95_m, 0.095, 1e-9);
  EXPECT_NEAR(figures.p99_m, 0.099, 1e-9);
  EXPECT_NEAR(figures.max_m, 0.1, 1e-9);
  EXPECT_NEAR(figures.normal_mean_m, 0.1 / 101, 1e-9);
  EXPECT_NEAR(figures.tangential_mean_m, 4.95 / 101, 1e-9);
  EXPECT_NEAR(figures.change_mean_m, 0.002, 1e-9);
  EXPECT_NEAR(figures.change_p95_m, 0.0029, 1e-9);
}

}  // namespace
}  // namespace fourdvt::measure

// SPDX-License-Identifier: Apache-2.0
// Fields on surfaces: distances from seams against exact ones on developable surfaces, and fields smoothed over time.
#include <cmath>
#include <functional>
#include <set>

#include "render/montage/layered_montage.h"
#include "surface_rig.h"

namespace fourdvt::testing {
namespace {

using glm::dvec2;
using render::kFieldSlots;
using render::kNoCamera;

constexpr double kSide = 0.013;  // metres, as the edges of the sample's mesh
constexpr float kClamp_m = 0.15f;

class FieldsTest : public GlFixture {
 protected:
  VertexValues distances(const Surface& surface, const VertexValues& seen, float clamp_m = kClamp_m,
                         int steps = render::kFieldSteps) {
    const auto model = modelOf(*device, surface);
    const ValueTables tables = uploadValues(*device, seen);
    render::SurfaceFields fields;
    const Status updated = fields.updateDistances(*device, model, tables.tables(), clamp_m, steps);
    EXPECT_TRUE(updated);
    return readValues(*device, fields.distances(), gpu::PixelFormat::RGBA16F, surface.positions.size());
  }
};

// [vertex] distance, for the slot, from the edges between vertices of seam triangles, on the unrolled surface, whose x
// repeats after `around` metres (0: never); in units of the clamp, at most 1.
std::vector<double> exactDistances(const Surface& surface, const VertexValues& seen, int slot, double around,
                                   double clamp_m = kClamp_m) {
  std::set<uint32_t> seam;
  for (const glm::uvec3& f : surface.faces)
    if (seen[f.x][slot] != seen[f.y][slot] || seen[f.x][slot] != seen[f.z][slot]) seam.insert({f.x, f.y, f.z});
  std::vector<std::array<dvec2, 2>> edges;
  for (const glm::uvec3& f : surface.faces)
    for (int k = 0; k < 3; ++k)
      if (seam.count(f[k]) && seam.count(f[(k + 1) % 3])) {
        dvec2 from = surface.flat[f[k]], to = surface.flat[f[(k + 1) % 3]];
        if (around > 0) to.x -= around * std::round((to.x - from.x) / around);
        for (int turn = around > 0 ? -1 : 0; turn <= (around > 0 ? 1 : 0); ++turn)
          edges.push_back({from + dvec2(turn * around, 0), to + dvec2(turn * around, 0)});
      }
  std::vector<double> out;
  for (const dvec2& point : surface.flat) {
    double least = 1e9;
    for (const auto& [from, to] : edges) {
      const double along = std::clamp(glm::dot(point - from, to - from) / glm::dot(to - from, to - from), 0.0, 1.0);
      least = std::min(least, glm::length(point - from - along * (to - from)));
    }
    out.push_back(std::min(least / clamp_m, 1.0));
  }
  return out;
}

VertexValues seenOf(const Surface& surface, const std::array<std::function<bool(dvec2)>, kFieldSlots>& slots) {
  VertexValues out(surface.flat.size());
  for (size_t v = 0; v < out.size(); ++v)
    for (int k = 0; k < kFieldSlots; ++k) out[v][k] = slots[k](surface.flat[v]) ? 1 : 0;
  return out;
}

double largestError(const std::vector<double>& exact, const VertexValues& got, int slot) {
  double largest = 0;
  for (size_t v = 0; v < exact.size(); ++v) largest = std::max(largest, std::abs(exact[v] - got[v][slot]));
  return largest;
}

TEST_F(FieldsTest, DistancesOnAPlaneAreExactWithinFivePercent) {
  const Surface surface = equilateral(52, 40, kSide);
  const VertexValues seen =
      seenOf(surface, {[](dvec2 p) { return p.y > 0; }, [](dvec2 p) { return p.x > 0.05; },
                       [](dvec2 p) { return p.x + 0.4 * p.y > 0; }, [](dvec2 p) { return glm::length(p) > 0.06; },
                       [](dvec2 p) { return glm::length(p - dvec2(0.1, 0)) > 0.01; },
                       [](dvec2 p) { return std::abs(p.x) > 0.05 || p.y > 0.02; }, [](dvec2) { return true; },
                       [](dvec2) { return false; }});
  // Parameters of characters from cameras and of layered ones (layered_montage.cpp).
  for (const auto& [clamp_m, steps] :
       {std::pair{kClamp_m, render::kFieldSteps}, std::pair{render::kLayeredClamp_m, render::kLayeredSteps}}) {
    const VertexValues got = distances(surface, seen, clamp_m, steps);
    for (int slot = 0; slot < 6; ++slot) {
      const auto exact = exactDistances(surface, seen, slot, 0, clamp_m);
      EXPECT_LT(largestError(exact, got, slot), 0.05) << slot << ", " << steps << " steps";
      double sum = 0;
      int count = 0;
      for (size_t v = 0; v < exact.size(); ++v)
        if (exact[v] > 0 && exact[v] < 1) sum += std::abs(got[v][slot] / exact[v] - 1), ++count;
      EXPECT_GT(count, 200) << slot;
      EXPECT_LT(sum / count, 0.04) << "relative, " << slot << ", " << steps << " steps";
    }
    for (int slot : {6, 7})
      for (const auto& values : got) ASSERT_EQ(values[slot], 1) << "no seam";
  }
}

// Two cameras look at a cylinder from opposite sides, others from between: two seams each.
TEST_F(FieldsTest, DistancesOnACylinderOfTwoCamerasRunRoundIt) {
  const Surface surface = equilateral(96, 44, kSide, true);
  ASSERT_GE(surface.faces.size(), 8000u);
  const double around = 96 * kSide;
  const auto facing = [around](double angle) {
    return [=](dvec2 p) { return std::cos(p.x / around * 2 * M_PI - angle) > 0.1; };
  };
  const auto never = [](dvec2) { return false; };
  const VertexValues seen =
      seenOf(surface, {facing(0), facing(M_PI), facing(1), facing(2.5), never, never, never, facing(-1.3)});
  for (const auto& [clamp_m, steps] :
       {std::pair{kClamp_m, render::kFieldSteps}, std::pair{render::kLayeredClamp_m, render::kLayeredSteps}}) {
    const VertexValues got = distances(surface, seen, clamp_m, steps);
    for (int slot : {0, 1, 2, 3, 7})
      EXPECT_LT(largestError(exactDistances(surface, seen, slot, around, clamp_m), got, slot), 0.05)
          << slot << ", " << steps << " steps";
  }
}

// Triangles of a third the side: the steps still reach the clamp, evenly.
TEST_F(FieldsTest, FineMeshesReachTheClampSooner) {
  const Surface surface = equilateral(100, 60, kSide / 3);
  const VertexValues seen = [&] {
    std::array<std::function<bool(dvec2)>, kFieldSlots> slots;
    slots.fill([](dvec2 p) { return p.y > 0; });
    return seenOf(surface, slots);
  }();
  for (const auto& [clamp_m, steps] :
       {std::pair{kClamp_m, render::kFieldSteps}, std::pair{render::kLayeredClamp_m, render::kLayeredSteps}}) {
    const VertexValues got = distances(surface, seen, clamp_m, steps);
    const double reach = steps * 0.85;  // rows that fade: of faces that count as larger
    float before = 0;
    for (int row = 31; row < 60; ++row) {
      const float here = got[row * 101 + 50][5];
      EXPECT_GE(here, before);
      EXPECT_LT(here - before, 1.36 / reach) << row << ", " << steps << " steps";
      before = here;
    }
    EXPECT_EQ(before, 1);
  }
}

TEST_F(FieldsTest, CamerasKeepTheirSlots) {
  const size_t first[] = {5, 2, 9};
  const render::FieldCameras a = render::keepSlots(render::kNoFieldCameras, first);
  EXPECT_EQ(a[0], 5u);
  EXPECT_EQ(a[1], 2u);
  EXPECT_EQ(a[2], 9u);
  const size_t second[] = {9, 7, 5, 1};
  const render::FieldCameras b = render::keepSlots(a, second);
  EXPECT_EQ(b[0], 5u);
  EXPECT_EQ(b[1], 7u);
  EXPECT_EQ(b[2], 9u);
  EXPECT_EQ(b[3], 1u);
  EXPECT_EQ(b[4], kNoCamera);
  const size_t many[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  const render::FieldCameras c = render::keepSlots(b, many);
  EXPECT_EQ(std::count(c.begin(), c.end(), kNoCamera), 0);
  EXPECT_EQ(c[0], 5u);
}

class FollowTest : public FieldsTest {
 protected:
  void SetUp() override {
    FieldsTest::SetUp();
    model_ = modelOf(*device, surface_);
    low_ = aims(0.2f), high_ = aims(0.8f);
  }
  void TearDown() override {
    model_ = {};
    low_ = {}, high_ = {};
    FieldsTest::TearDown();
  }
  ValueTables aims(float value) {
    VertexValues values(surface_.positions.size());
    for (auto& v : values) v.fill(value);
    return uploadValues(*device, values);
  }
  void follow(render::SurfaceFields& fields, const ValueTables& aims, float elapsed_s,
              std::vector<size_t> cameras = {0, 1, 2, 3, 4, 5, 6, 7}) {
    const Status followed = fields.follow(*device, model_, aims.tables(), cameras, elapsed_s, kSettling_s);
    EXPECT_TRUE(followed);
  }
  std::array<float, kFieldSlots> at(const render::SurfaceFields& fields, size_t vertex) {
    return readValues(*device, fields.fields(), gpu::PixelFormat::RGBA16F, surface_.positions.size())[vertex];
  }

  static constexpr float kSettling_s = 0.17f, kStill = std::numeric_limits<float>::infinity();
  Surface surface_ = equilateral(8, 8, 0.1);
  render::CharacterModel model_;
  ValueTables low_, high_;
};

TEST_F(FollowTest, TheHalfLifeIsThatOfTheClockWhateverTheFrameRate) {
  const float half_life_s = kSettling_s * std::log(2.0f);
  for (const int pictures : {1, 2, 7, 40}) {
    render::SurfaceFields fields;
    follow(fields, low_, 0.02f);
    EXPECT_NEAR(at(fields, 3)[0], 0.2, 0.002) << "the first is at once";
    for (int i = 0; i < pictures; ++i) follow(fields, high_, half_life_s / pictures);
    for (float value : at(fields, 40)) EXPECT_NEAR(value, 0.5, 0.004) << pictures << " pictures";
  }
}

TEST_F(FollowTest, AnAbruptTurnIsNoJumpAndAStillIsAtOnce) {
  render::SurfaceFields fields;
  follow(fields, low_, kStill);
  follow(fields, high_, 1.0f / 60);
  EXPECT_NEAR(at(fields, 0)[5], 0.8 - 0.6 * std::exp(-1.0 / 60 / kSettling_s), 0.002);
  follow(fields, low_, 0);
  EXPECT_NEAR(at(fields, 0)[5], 0.8 - 0.6 * std::exp(-1.0 / 60 / kSettling_s), 0.002) << "no time has passed";
  follow(fields, high_, kStill);
  EXPECT_NEAR(at(fields, 0)[5], 0.8, 0.002);
}

// Uninitialised tables may contain NaN.
TEST_F(FollowTest, WhatIsNoNumberDoesNotLastWhereFieldsAreTheAims) {
  ValueTables broken;
  for (gpu::Texture* texture : {&broken.low, &broken.high}) {
    *texture = render::makeTable(*device, gpu::PixelFormat::RGBA32F, surface_.positions.size(), "values").take();
    std::vector<glm::vec4> table;
    const glm::vec4 nothing(std::numeric_limits<float>::quiet_NaN());
    render::resizeToRows(table, surface_.positions.size(), nothing);
    std::fill(table.begin(), table.end(), nothing);
    render::uploadTable(*device, *texture, table);
  }
  render::SurfaceFields fields;
  follow(fields, broken, kStill);
  ASSERT_TRUE(std::isnan(at(fields, 3)[1]));
  follow(fields, high_, kStill);
  for (float value : at(fields, 3)) EXPECT_NEAR(value, 0.8, 0.002);
}

TEST_F(FollowTest, ACameraThatComesIntoASlotStartsFromNothing) {
  render::SurfaceFields fields;
  follow(fields, low_, kStill);
  follow(fields, low_, kSettling_s, {0, 1, 2, 3, 4, 9, 6});
  const auto got = at(fields, 11);
  EXPECT_NEAR(got[0], 0.2, 0.002);
  EXPECT_NEAR(got[5], 0.2 * (1 - std::exp(-1.0)), 0.002);
  EXPECT_NEAR(got[7], 0.2 * (1 - std::exp(-1.0)), 0.002);
}

// Vertices differ in every frame; each takes the field at its place.
TEST_F(FollowTest, FieldsAreCarriedOverToAnotherTopology) {
  const auto rising = [&](const Surface& surface) {
    VertexValues values(surface.positions.size());
    for (size_t v = 0; v < values.size(); ++v) values[v].fill(static_cast<float>(surface.flat[v].x + 0.5));
    return uploadValues(*device, values);
  };
  const std::vector<size_t> cameras = {0, 1, 2, 3, 4, 5, 6, 7};
  render::SurfaceFields fields;
  const Surface surfaces[] = {equilateral(20, 20, 0.04), equilateral(36, 30, 0.02), equilateral(24, 26, 0.03)};
  render::CharacterModel model = modelOf(*device, surfaces[0], 2000);
  ASSERT_TRUE(fields.follow(*device, model, rising(surfaces[0]).tables(), cameras, 0.01f, kSettling_s));
  for (const Surface* surface : {&surfaces[1], &surfaces[2]}) {
    ASSERT_TRUE(model.setTopology(*device, surface->faces, static_cast<uint32_t>(surface->positions.size())));
    model.setPositions(*device, surface->positions);
    VertexValues zeros(surface->positions.size());
    const ValueTables aims = surface == &surfaces[1] ? rising(*surface) : uploadValues(*device, zeros);
    ASSERT_TRUE(fields.follow(*device, model, aims.tables(), cameras, 0, kSettling_s));
  }
  const auto got = readValues(*device, fields.fields(), gpu::PixelFormat::RGBA16F, surfaces[2].positions.size());
  const double reach = 18 * 0.02;  // half the second surface's width
  int inside = 0;
  for (size_t v = 0; v < got.size(); ++v) {
    const dvec2 at = surfaces[2].flat[v];
    if (std::abs(at.x) > reach - 0.02 || std::abs(at.y) > 0.2) continue;
    ++inside;
    for (int slot : {0, 7}) EXPECT_NEAR(got[v][slot], at.x + 0.5, 0.025);
  }
  EXPECT_GT(inside, 150);
}

}  // namespace
}  // namespace fourdvt::testing

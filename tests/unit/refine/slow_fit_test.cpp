// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "refine/camera_fit.h"
#include "sphere_fixture.h"

namespace fourdvt::refine {
namespace {

constexpr int kFrames = 12, kCameras = 6;

// Every camera observes every other vertex; `offset`: its value at a frame.
template <class Offset>
std::vector<SlowFrame> claims(const BallMesh& mesh, uint32_t step, double noise, const Offset& offset) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  std::vector<SlowFrame> out;
  for (uint32_t f = 0; f < kFrames; ++f) {
    SlowFrame frame{f * step, std::vector<std::vector<OffsetClaim>>(kCameras)};
    for (auto& camera : frame.claims)
      for (uint32_t v = 0; v < mesh.positions.size(); v += 2)
        camera.push_back({v, v, 0, float(offset(f) + noise * normal(random))});
    out.push_back(std::move(frame));
  }
  return out;
}

double breathing(uint32_t frame) { return 0.003 * std::sin(2 * 3.14159265 * frame / kFrames); }

TEST(SlowFit, SurfaceThatBreathesIsFollowed) {
  const BallMesh mesh = ballMesh(1, 2);
  const auto fit = fitSlowOffsets(claims(mesh, 2, 0.001, breathing), mesh.edges, mesh.positions.size(), 2 * kFrames);
  ASSERT_TRUE(fit.has_value());
  ASSERT_EQ(fit->frames.size(), size_t(kFrames));
  EXPECT_EQ(fit->loop_frames, uint32_t(2 * kFrames));
  // Regularised towards zero, so that it follows only most of the way.
  double left = 0, all = 0;
  for (uint32_t f = 0; f < kFrames; ++f)
    for (const float offset : fit->offset_m[f]) {
      left += std::pow(offset - breathing(f), 2);
      all += std::pow(breathing(f), 2);
    }
  EXPECT_LT(std::sqrt(left / all), 0.55);
}

TEST(SlowFit, OnALoopTheLastFrameIsBesideTheFirst) {
  const BallMesh mesh = ballMesh(1, 2);
  const auto last = [](uint32_t f) { return f >= kFrames / 2 ? 0.004 : -0.004; };
  const auto input = claims(mesh, 2, 0, last);
  const auto loop = fitSlowOffsets(input, mesh.edges, mesh.positions.size(), 2 * kFrames),
             open = fitSlowOffsets(input, mesh.edges, mesh.positions.size(), 0);
  ASSERT_TRUE(loop.has_value() && open.has_value());
  EXPECT_GT(loop->offset_m[0][0], open->offset_m[0][0] + 1e-4f);
}

TEST(SlowFit, NoiseIsNotFollowed) {
  const BallMesh mesh = ballMesh(1, 2);
  const auto still = [](uint32_t) { return 0.0; };
  EXPECT_FALSE(fitSlowOffsets(claims(mesh, 2, 0.001, still), mesh.edges, mesh.positions.size(), 0).has_value());
}

TEST(SlowFit, FramesTooFarApartSayNothingAboutThoseBetween) {
  const BallMesh mesh = ballMesh(1, 2);
  EXPECT_FALSE(fitSlowOffsets(claims(mesh, 20, 0.001, breathing), mesh.edges, mesh.positions.size(), 0).has_value());
}

}  // namespace
}  // namespace fourdvt::refine

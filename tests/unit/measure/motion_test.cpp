// SPDX-License-Identifier: Apache-2.0
// Measures of blended and moving appearance, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "lab/measure/motion_metrics.h"

namespace fourdvt::measure {
namespace {

constexpr int kSide = 128;

Image grating(double wavelength, double phase, double contrast = 60) {
  Image out(kSide, kSide, 3);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      std::fill_n(out.at(x, y), 3,
                  static_cast<uint8_t>(std::lround(128 + contrast * std::sin(2 * M_PI * x / wavelength + phase))));
  return out;
}

Image mean(const Image& a, const Image& b) {
  Image out = a;
  for (size_t i = 0; i < out.pixels.size(); ++i)
    out.pixels[i] = static_cast<uint8_t>((a.pixels[i] + b.pixels[i] + 1) / 2);
  return out;
}

Mask everywhere() { return Mask(kSide * kSide, 1); }

TEST(Sharpness, OfAGratingHasClosedForm) {
  // Central differences of A sin(kx) are A sin(k) cos(kx): the mean square is (A sin k)² / 2; the Laplacian's is
  // (2 A (1 - cos k))² / 2.
  const double k = 2 * M_PI / 16;
  Mask whole_periods = everywhere();
  for (size_t i = 0; i < whole_periods.size(); ++i) whole_periods[i] = i % kSide >= 1 && i % kSide <= 112;
  const Sharpness s = sharpness(grating(16, 0.3), whole_periods);
  EXPECT_NEAR(s.gradient, std::pow(60 * std::sin(k), 2) / 2, 1);
  EXPECT_NEAR(s.detail, std::pow(2 * 60 * (1 - std::cos(k)), 2) / 2, 1);
}

TEST(Sharpness, FallsWithTheCosineOfADoubleImagesPhase) {
  // The mean of two gratings at a phase difference has the contrast cos(difference / 2).
  const Image a = grating(16, 0), b = grating(16, 1.2);
  const double ratio = sharpness(mean(a, b), everywhere()).gradient / sharpness(a, everywhere()).gradient;
  EXPECT_NEAR(ratio, std::pow(std::cos(0.6), 2), 0.02);
  EXPECT_NEAR(sharpness(mean(a, a), everywhere()).gradient / sharpness(a, everywhere()).gradient, 1, 1e-9);
}

TEST(Sharpness, OutsideTheRegionDoesNotCount) {
  Image picture = grating(16, 0);
  Mask left = everywhere();
  for (int y = 0; y < kSide; ++y)
    for (int x = kSide / 2; x < kSide; ++x) left[size_t(y) * kSide + x] = 0;
  left = eroded(left, kSide, kSide, 2);
  const Sharpness before = sharpness(picture, left);
  for (int y = 0; y < kSide; ++y)
    for (int x = kSide / 2; x < kSide; ++x) std::fill_n(picture.at(x, y), 3, uint8_t(x % 2 ? 255 : 0));
  EXPECT_EQ(sharpness(picture, left).gradient, before.gradient);
  EXPECT_TRUE(std::isnan(sharpness(picture, Mask(kSide * kSide, 0)).gradient));
}

TEST(Eroded, LeavesWhatIsFarEnoughFromTheEdge) {
  Mask square(20 * 10, 0);
  for (int y = 2; y < 9; ++y)
    for (int x = 3; x < 15; ++x) square[size_t(y) * 20 + x] = 1;
  const Mask out = eroded(square, 20, 10, 2);
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 20; ++x)
      EXPECT_EQ(out[size_t(y) * 20 + x] != 0, y >= 4 && y < 7 && x >= 5 && x < 13) << x << " " << y;
  EXPECT_EQ(std::count(out.begin(), out.end(), 1), 3 * 8);
}

PinholeCamera frontCamera() {
  PinholeCamera camera;
  camera.width = 80, camera.height = 60;
  camera.fx = camera.fy = 50, camera.cx = 40, camera.cy = 30;
  return camera;  // at the origin, along +z
}

// A quad that fills the picture, tilted in depth.
struct Quad {
  Positions positions{{-3, -3, 2}, {3, -3, 2}, {3, 3, 4}, {-3, 3, 4}};
  std::vector<glm::uvec3> faces{{0, 1, 2}, {0, 2, 3}};
  std::vector<glm::vec3> movedBy(const glm::vec3& d) const {
    std::vector<glm::vec3> out;
    for (const glm::uvec3& f : faces)
      for (int k = 0; k < 3; ++k) out.push_back(positions[f[k]] + d);
    return out;
  }
};

TEST(SurfaceFlow, OfAShiftIsFocalLengthTimesShiftOverDepth) {
  const Quad quad;
  std::vector<float> metres;
  const FlowField flow = surfaceFlow(frontCamera(), quad.faces, quad.positions, quad.movedBy({0.04f, 0, 0}), &metres);
  size_t seen = 0;
  for (size_t i = 0; i < flow.displacement.size(); ++i) {
    if (std::isnan(flow.displacement[i].x)) continue;
    ++seen;
    EXPECT_NEAR(flow.displacement[i].x * metres[i], 0.04, 1e-5);  // metres = depth / f
    EXPECT_NEAR(flow.displacement[i].y, 0, 1e-4);
  }
  EXPECT_GT(seen, 2000u);
  const FlowField still = surfaceFlow(frontCamera(), quad.faces, quad.positions, quad.movedBy({0, 0, 0}));
  for (const glm::vec2& f : still.displacement) {
    if (!std::isnan(f.x)) {
      EXPECT_LT(glm::length(f), 1e-4f);
    }
  }
}

TEST(SurfaceFlow, OffTheSurfaceNothingIsKnown) {
  Quad quad;
  for (glm::vec3& p : quad.positions) p.x = std::min(p.x, 0.f);
  const FlowField flow = surfaceFlow(frontCamera(), quad.faces, quad.positions, quad.movedBy({0, 0, 0}));
  EXPECT_TRUE(std::isnan(flow.displacement[30 * 80 + 70].x));
  EXPECT_FALSE(std::isnan(flow.displacement[30 * 80 + 20].x));
}

FlowField field(const std::function<glm::vec2(double, double)>& at) {
  FlowField out{kSide, kSide, {}};
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) out.displacement.push_back(at(x + 0.5, y + 0.5));
  return out;
}

TEST(FlowDifferences, MeanAndTailOfAKnownError) {
  const FlowField truth = field([](double x, double y) { return glm::vec2(0.1 * x, -0.05 * y); });
  FlowField found = truth;
  Mask inside(kSide * kSide, 0);
  for (int i = 0; i < 1000; ++i) {
    inside[size_t(i)] = 1;
    found.displacement[size_t(i)] += i < 900 ? glm::vec2(0.3f, 0.4f) : glm::vec2(0, 5);
  }
  found.displacement[5000] += glm::vec2(100);  // outside
  ErrorSamples samples;
  addDifferences(truth, found, inside, samples);
  EXPECT_EQ(samples.count(), 1000u);
  EXPECT_NEAR(samples.mean(), (900 * 0.5 + 100 * 5) / 1000, 1e-4);
  EXPECT_NEAR(samples.tail(), 5, 1e-4);
  EXPECT_TRUE(std::isnan(ErrorSamples().mean()));
}

TEST(FlowDifferences, BetweenPixelsAFlowIsBilinear) {
  const FlowField flow = field([](double x, double y) { return glm::vec2(0.1 * x + 0.02 * y, 3 - 0.2 * y); });
  EXPECT_NEAR(glm::distance(flowAt(flow, {20.3, 40.9}), glm::vec2(2.03 + 0.818, 3 - 8.18)), 0, 1e-4);
  EXPECT_TRUE(std::isnan(flowAt(flow, {0.2, 50}).x));
  EXPECT_TRUE(std::isnan(flowAt(flow, {50, kSide + 3.0}).x));
}

TEST(Changes, PictureAndVertexStepsAreTheLargestAndTheMean) {
  Image a(4, 2, 4, 0), b(4, 2, 4, 0);
  for (int x = 0; x < 2; ++x) std::fill_n(a.at(x, 0), 4, uint8_t{255}), std::fill_n(b.at(x, 0), 4, uint8_t{255});
  b.at(0, 0)[1] = 225;
  EXPECT_NEAR(pictureChange(a, b), 30.0 / 6, 1e-9);  // two pixels, three channels
  EXPECT_EQ(pictureChange(Image(4, 2, 4, 0), Image(4, 2, 4, 0)), 0);
  EXPECT_NEAR(largestStep_m({{0, 0, 0}, {1, 0, 0}}, {{0, 0.1f, 0}, {1, 0, 0.3f}}), 0.3, 1e-6);
}

}  // namespace
}  // namespace fourdvt::measure

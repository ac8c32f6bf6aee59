// SPDX-License-Identifier: Apache-2.0
// Removed parts of the hull are restored if silhouettes require them, and no others.
#include "reconstruct/stereo/outlines.h"

#include <gtest/gtest.h>

#include <numeric>
#include <opencv2/core/utility.hpp>

#include "base/face_buffer.h"
#include "silhouette_fixture.h"

namespace fourdvt::reconstruct {
namespace {

constexpr double kVoxel_m = 0.008;
constexpr int kSamples = 4;  // per pixel, along each side

// The hull of a shape, and what stereo has left of it.
struct Taken {
  Rig rig;
  std::vector<silhouette::Silhouette> silhouettes;
  std::vector<CarvingView> views;
  SparseDistance hull, left;

  // Removes the hull where `keeps` is negative, by its amount.
  Taken(const Shape& shape, const std::function<double(const glm::dvec3&)>& keeps)
      : rig(ringCameras(8), shape), silhouettes(rig.silhouettes()) {
    for (const silhouette::Silhouette& s : silhouettes)
      views.push_back({&s, silhouette::SilhouetteDistance(s.coverage)});
    hull = withValuesInside(carve(views, kVoxel_m).take());
    left = hull;
    for (SparseDistance::Block& block : left.blocks)
      for (size_t i = 0; i < block.values.size(); ++i) {
        const glm::dvec3 place = left.origin_in_world + glm::dvec3(voxelOf(block, i)) * left.voxel_m;
        block.values[i] = std::clamp(std::min(block.values[i], float(keeps(place))), -left.band_m, left.band_m);
      }
  }
  OutlineFigures keep() { return keepOutlines(hull, views, {}, left); }
};

// Covered part of a row of samples.
struct Span {
  int first = -1, last = -1;
  void add(int x) { first = first < 0 ? x : first, last = x; }
};

// Distances in pixels between the ends of a surface's rows and those of the shape, where both have any, sorted; -1
// first for each row in which the surface is missing.
std::vector<double> besideShape(const PinholeCamera& camera, const SparseDistance& distance, const Shape& shape,
                                int first_row, int last_row) {
  SparseDistance closed = distance;
  compact(closed);
  const TriangleMesh mesh = zeroSurface(closed, 0);
  const FaceBuffer drawn = rasterise(camera, mesh.faces, mesh.positions, kSamples);
  std::vector<double> out;
  for (int y = first_row * kSamples; y < last_row * kSamples; ++y) {
    Span surface, truth;
    for (int x = 0; x < drawn.width; ++x) {
      if (drawn.face[size_t(y) * drawn.width + x] != FaceBuffer::kNoFace) surface.add(x);
      const glm::dvec2 pixel((x + 0.5) / kSamples, (y + 0.5) / kSamples);
      if (shape(camera.centreInWorld(), rayInWorld(camera, pixel))) truth.add(x);
    }
    if (truth.first < 0) continue;
    if (surface.first < 0) {
      out.push_back(-1);
      continue;
    }
    out.push_back(std::abs(surface.first - truth.first) / double(kSamples));
    out.push_back(std::abs(surface.last - truth.last) / double(kSamples));
  }
  std::sort(out.begin(), out.end());
  return out;
}

void expectWithinTheHull(const Taken& t, const SparseDistance& before) {
  for (size_t b = 0; b < t.hull.blocks.size(); ++b)
    for (size_t i = 0; i < t.hull.blocks[b].values.size(); ++i) {
      ASSERT_LE(t.left.blocks[b].values[i], t.hull.blocks[b].values[i]);
      ASSERT_GE(t.left.blocks[b].values[i], before.blocks[b].values[i]);
    }
}

const Shape kBallWithRod =
    either(ballShape({0, 0, 0}, 0.25), boxShape({-0.012, 0.2, -0.012}, {0.012, 0.55, 0.012}));  // 3.5 pixels thick
const Shape kBox = boxShape({-0.3, -0.3, -0.3}, {0.3, 0.3, 0.3});

TEST(Outlines, GivesBackAThinRodThatWasTaken) {
  Taken t(kBallWithRod, [](const glm::dvec3& p) { return 0.3 - p.y; });
  const SparseDistance before = t.left;
  for (size_t c = 0; c < 2; ++c) {
    const glm::dvec3 top = t.rig.cameras[c].project({0, 0.53, 0}), foot = t.rig.cameras[c].project({0, 0.32, 0});
    ASSERT_EQ(besideShape(t.rig.cameras[c], before, kBallWithRod, int(top.y), int(foot.y)).front(), -1);
  }
  const OutlineFigures figures = t.keep();
  EXPECT_GT(figures.missing, 500u);
  EXPECT_LT(figures.left, figures.missing / 10);
  for (const PinholeCamera& camera : t.rig.cameras) {
    const int top = int(camera.project({0, 0.53, 0}).y), foot = int(camera.project({0, 0.32, 0}).y);
    const auto beside = besideShape(camera, t.left, kBallWithRod, top, foot);
    EXPECT_GE(beside.front(), 0) << camera.name << ": the rod is interrupted";
    EXPECT_LE(beside[beside.size() / 2], 0.5) << camera.name;
    EXPECT_LE(beside.back(), 1.5) << camera.name;
  }
  expectWithinTheHull(t, before);
}

// Depths slightly too large everywhere: the outline is restored; if the whole surface is removed by a voxel or more,
// the middle of the sides that face cameras stays unchanged.
TEST(Outlines, GivesBackARim) {
  Taken t(kBox, [](const glm::dvec3& p) { return 0.285 - std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); });
  const SparseDistance before = t.left;
  const PinholeCamera& camera = t.rig.cameras[0];
  const auto taken = besideShape(camera, before, kBox, 90, 150);
  ASSERT_GT(taken[taken.size() / 2], 1.5);
  t.keep();
  for (const PinholeCamera& c : t.rig.cameras) {
    const auto beside = besideShape(c, t.left, kBox, 90, 150);
    EXPECT_LE(beside[beside.size() / 2], 0.5) << c.name;
  }
  expectWithinTheHull(t, before);
  const auto valueAt = [](const SparseDistance& d, const glm::dvec3& place) {
    const glm::ivec3 voxel(glm::round((place - d.origin_in_world) / d.voxel_m));
    for (const SparseDistance::Block& block : d.blocks) {
      const glm::ivec3 in = voxel - block.at;
      if (glm::all(glm::greaterThanEqual(in, glm::ivec3(0))) && glm::all(glm::lessThan(in, glm::ivec3(kBlock))))
        return block.values[in.x * 64 + in.y * 8 + in.z];
    }
    return -d.band_m;
  };
  for (const glm::dvec3 side : {glm::dvec3(0, 0, 0.29), glm::dvec3(0.29, 0, 0), glm::dvec3(0, -0.1, -0.29)})
    EXPECT_EQ(valueAt(t.left, side), valueAt(before, side));
}

// A dent that no outline shows stays, and so does the unchanged hull.
TEST(Outlines, LeavesAloneWhatNoRayMisses) {
  for (const double dent_m : {0.12, 0.0}) {
    Taken t(kBox, [=](const glm::dvec3& p) { return glm::distance(p, glm::dvec3(0.02, 0, 0.3)) - dent_m; });
    const SparseDistance before = t.left;
    const OutlineFigures figures = t.keep();
    EXPECT_GT(figures.rays, 10000u);
    EXPECT_EQ(figures.missing, 0u) << dent_m;
    for (size_t b = 0; b < before.blocks.size(); ++b) ASSERT_EQ(t.left.blocks[b].values, before.blocks[b].values);
  }
}

TEST(Outlines, ClosesATunnelThatASilhouetteLacks) {
  const glm::dvec3 along = glm::normalize(ringCameras(8)[0].centreInWorld());
  Taken t(kBox, [=](const glm::dvec3& p) { return glm::length(p - glm::dot(p, along) * along) - 0.04; });
  EXPECT_GT(t.keep().missing, 10u);
  SparseDistance closed = t.left;
  compact(closed);
  const TriangleMesh mesh = zeroSurface(closed, 0);
  const FaceBuffer drawn = rasterise(t.rig.cameras[0], mesh.faces, mesh.positions, 1);
  for (int y = 110; y < 130; ++y)
    for (int x = 110; x < 130; ++x) EXPECT_NE(drawn.face[size_t(y) * drawn.width + x], FaceBuffer::kNoFace);
}

TEST(Outlines, IsTheSameOnAnyNumberOfThreads) {
  const int threads = cv::getNumThreads();
  std::vector<SparseDistance> out;
  for (const int count : {1, 4}) {
    cv::setNumThreads(count);
    Taken t(kBallWithRod, [](const glm::dvec3& p) { return 0.24 - glm::length(p); });
    t.keep();
    out.push_back(t.left);
  }
  cv::setNumThreads(threads);
  for (size_t b = 0; b < out[0].blocks.size(); ++b) ASSERT_EQ(out[0].blocks[b].values, out[1].blocks[b].values);
}

TEST(Outlines, NoRoundsChangeNothing) {
  Taken t(kBallWithRod, [](const glm::dvec3& p) { return 0.3 - p.y; });
  const SparseDistance before = t.left;
  EXPECT_GT(keepOutlines(t.hull, t.views, {.rounds = 0}, t.left).left, 0u);
  for (size_t b = 0; b < before.blocks.size(); ++b) EXPECT_EQ(t.left.blocks[b].values, before.blocks[b].values);
}

}  // namespace
}  // namespace fourdvt::reconstruct

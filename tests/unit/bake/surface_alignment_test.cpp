// SPDX-License-Identifier: Apache-2.0
#include "bake/align/surface_alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "bake/align/tangent_field.h"
#include "bake/align/views.h"

namespace fourdvt::bake {
namespace {

// Square of n × n cells in the plane z = 0, facing +Z, sides of 1 m, lower left corner at the origin; texture
// coordinates cover 0.25…0.75.
struct Grid {
  MeshTopology topology;
  Positions positions;

  explicit Grid(uint32_t n) {
    for (uint32_t y = 0; y <= n; ++y)
      for (uint32_t x = 0; x <= n; ++x) {
        positions.emplace_back(float(x) / n, float(y) / n, 0);
        topology.uvs.emplace_back(0.25f + 0.5f * x / n, 0.75f - 0.5f * y / n);
      }
    for (uint32_t y = 0; y < n; ++y)
      for (uint32_t x = 0; x < n; ++x) {
        const uint32_t a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
        topology.face_vertices.push_back({a, b, d});
        topology.face_vertices.push_back({a, d, c});
      }
    topology.face_uvs = topology.face_vertices;
    topology.vertex_count = uint32_t(positions.size());
  }
  SurfaceFrames frames() const { return computeSurfaceFrames(topology, positions); }
};

// Upright cylinder of radius 0.2 m: tangent directions turn from vertex to vertex.
struct Tube {
  static constexpr uint32_t kSegments = 24, kRings = 12;
  MeshTopology topology;
  Positions positions;

  Tube() {
    for (uint32_t ring = 0; ring <= kRings; ++ring)
      for (uint32_t s = 0; s < kSegments; ++s) {
        const double turn = 2 * M_PI * s / kSegments;
        positions.emplace_back(0.2 * std::sin(turn), 0.05 * ring, 0.2 * std::cos(turn));
        topology.uvs.emplace_back(0.1 + 0.8 * s / kSegments, 0.1 + 0.8 * ring / kRings);
      }
    for (uint32_t ring = 0; ring < kRings; ++ring)
      for (uint32_t s = 0; s < kSegments; ++s) {
        const uint32_t a = ring * kSegments + s, b = ring * kSegments + (s + 1) % kSegments;
        topology.face_vertices.push_back({a, b, a + kSegments});
        topology.face_vertices.push_back({b, b + kSegments, a + kSegments});
      }
    topology.face_uvs = topology.face_vertices;
    topology.vertex_count = uint32_t(positions.size());
  }
};

PinholeCamera frontCamera() {
  OrbitView orbit;
  orbit.target_in_world = {0.5, 0.5, 0};
  return cameraFromOrbit(orbit, 200, 160);
}

std::vector<glm::vec3> normalsOf(const MeshTopology& topology, const Positions& positions) {
  std::vector<glm::vec3> normals;
  computeVertexNormals(topology.face_vertices, positions.data(), positions.size(), normals);
  return normals;
}

// Band-limited noise; `shift` moves the content.
cv::Mat noisePicture(const cv::Size& size, const cv::Vec2d& shift) {
  cv::Mat big(size.height + 40, size.width + 40, CV_32F), out;
  cv::RNG random(7);
  random.fill(big, cv::RNG::UNIFORM, 0, 1);
  cv::GaussianBlur(big, big, cv::Size(), 2.5);
  cv::normalize(big, big, 0, 255, cv::NORM_MINMAX);
  const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, 20 - shift[0], 0, 1, 20 - shift[1]);
  cv::warpAffine(big, out, move, size, cv::INTER_CUBIC | cv::WARP_INVERSE_MAP);
  out.convertTo(out, CV_8U);
  return out;
}

std::vector<SeenVertex> pixelGrid(const cv::Size& size) {
  std::vector<SeenVertex> seen;
  for (int y = 30; y < size.height - 30; y += 10)
    for (int x = 30; x < size.width - 30; x += 10)
      seen.push_back({uint32_t(seen.size()), glm::vec2(x, y), 1, 400, glm::mat2(400)});
  return seen;
}

float mean(const glm::mat2& certainty) { return 0.5f * (certainty[0][0] + certainty[1][1]); }

// Mixture of a common and an own noise in the given shares; opaque within a border.
cv::Mat noisyLook(double common, double own, int seed) {
  constexpr int kSide = 160, kBorder = 12;
  cv::Mat luma = cv::Mat::zeros(kSide, kSide, CV_32F);
  for (const auto& [share, from] : {std::pair(common, 1), std::pair(own, seed)}) {
    cv::Mat noise(kSide, kSide, CV_32F);
    cv::RNG(from).fill(noise, cv::RNG::NORMAL, 0, 20);
    luma += share * noise;
  }
  luma += 128;
  cv::Mat look(kSide, kSide, CV_8UC4, cv::Scalar(0));
  for (int y = kBorder; y < kSide - kBorder; ++y)
    for (int x = kBorder; x < kSide - kBorder; ++x) {
      const uint8_t l = cv::saturate_cast<uint8_t>(luma.at<float>(y, x));
      look.at<cv::Vec4b>(y, x) = {l, l, l, 255};
    }
  return look;
}

TEST(DetailCorrelation, IsTheShareOfCommonDetail) {
  for (const double share : {0.0, 0.5, 0.9, 1.0})
    for (const int members : {2, 3}) {
      std::vector<cv::Mat> looks;
      for (int m = 0; m < members; ++m) looks.push_back(noisyLook(std::sqrt(share), std::sqrt(1 - share), 2 + m));
      EXPECT_NEAR(detailCorrelation({detailEnergy(looks)}), share, 0.03) << members;
    }
  EXPECT_EQ(detailCorrelation({}), 1);
}

TEST(SurfaceAlignmentViews, CamerasHoldAllPointsAndEveryOtherOneIsRaised) {
  const Tube tube;
  const auto cameras = alignmentCameras(tube.positions, 6, 200);
  ASSERT_EQ(cameras.size(), 6u);
  for (size_t i = 0; i < cameras.size(); ++i) {
    EXPECT_EQ(cameras[i].height, 200);
    double low = 1e9, high = -1e9;
    for (const glm::vec3& position : tube.positions) {
      const glm::dvec3 at = cameras[i].project(position);
      EXPECT_GT(at.x, 8);
      EXPECT_LT(at.x, cameras[i].width - 8);
      low = std::min(low, at.y);
      high = std::max(high, at.y);
    }
    EXPECT_NEAR(low, 12, 0.5);
    EXPECT_NEAR(high, 188, 0.5);
    EXPECT_EQ(cameras[i].centreInWorld().y > 0.5, i % 2 == 1);
  }
}

TEST(SurfaceAlignmentViews, PoseTangentsFollowTurnAndStretch) {
  const Tube tube;
  const SurfaceFrames frames = computeSurfaceFrames(tube.topology, tube.positions);
  Positions turned;
  for (const glm::vec3& p : tube.positions) turned.emplace_back(p.z, 3 * p.y, -p.x);
  const auto tangents = poseTangents(tube.topology, tube.positions, frames, turned);
  for (uint32_t v = 0; v < tube.topology.vertex_count; ++v)
    for (int k = 0; k < 2; ++k) {
      const glm::vec3 t = frames.tangents[v][k];
      EXPECT_NEAR(glm::distance(tangents[v][k], glm::vec3(t.z, 3 * t.y, -t.x)), 0, 0.03) << v;
    }
}

TEST(SurfaceAlignmentViews, FaceWithoutAreaGivesNoTangent) {
  Grid grid(2);
  for (glm::vec3& p : grid.positions) p.y = 0;
  for (const glm::mat2x3& t : poseTangents(grid.topology, grid.positions, grid.frames(), grid.positions))
    EXPECT_EQ(t, glm::mat2x3(0));
}

TEST(SurfaceAlignmentViews, SeesFrontFacesOnlyAndProjectsTangents) {
  Grid grid(4);
  const uint32_t front_count = grid.topology.vertex_count;
  Grid behind(4);  // 0.2 m behind; larger, so that its border is visible
  for (const glm::vec3& p : behind.positions) grid.positions.push_back(glm::vec3(1.5f * glm::vec2(p) - 0.25f, -0.2f));
  for (const glm::uvec3& face : behind.topology.face_vertices)
    grid.topology.face_vertices.push_back(face + front_count);
  grid.topology.face_uvs = grid.topology.face_vertices;
  grid.topology.uvs.insert(grid.topology.uvs.end(), behind.topology.uvs.begin(), behind.topology.uvs.end());
  grid.topology.vertex_count *= 2;
  const PinholeCamera camera = frontCamera();
  const auto frames = grid.frames();
  const auto tangents = poseTangents(grid.topology, grid.positions, frames, grid.positions);
  const cv::Mat depth = drawDepth(camera, grid.topology, grid.positions);
  const auto seen = seenVertices(camera, depth, grid.positions, normalsOf(grid.topology, grid.positions), tangents);
  ASSERT_EQ(seen.size(), 25u + 16u);  // the hidden 3 × 3 of the second grid are missing
  for (const SeenVertex& s : seen)
    for (int k = 0; k < 2; ++k) {
      const glm::dvec3 p(grid.positions[s.vertex]), step = 1e-3 * glm::dvec3(tangents[s.vertex][k]);
      const glm::dvec2 moved = glm::dvec2(camera.project(p + step) - camera.project(p - step)) / 2e-3;
      EXPECT_NEAR(glm::distance(moved, glm::dvec2(s.pixels_from_tangents[k])), 0, 0.1);
    }
}

TEST(SurfaceAlignmentViews, InteriorKeepsOffDepthSteps) {
  cv::Mat depth(20, 40, CV_32F, cv::Scalar(2));
  depth.colRange(20, 40) = 2.5;
  const cv::Mat interior = interiorOf(depth, 5);
  EXPECT_EQ(interior.at<float>(10, 19), 0);
  EXPECT_GT(interior.at<float>(10, 16), 0.4f);
  EXPECT_LT(interior.at<float>(10, 16), 0.8f);
  EXPECT_EQ(interior.at<float>(10, 10), 1);
}

TEST(SurfaceAlignmentLift, ReadsFlowHalfWayAndDoubtsPlainPlaces) {
  const cv::Size size(160, 120);
  cv::Mat first = noisePicture(size, {0, 0}), other = noisePicture(size, {2.5, -1.5});
  first.colRange(110, 160) = 128;
  other.colRange(110, 160) = 128;
  const cv::Mat interior(size, CV_32F, cv::Scalar(1));
  for (const FlowObservation& seen : observeFlow(first, other, interior, pixelGrid(size))) {
    const float x = 30.0f + 10 * float(seen.vertex % 10);
    if (x <= 80) {
      EXPECT_NEAR(seen.flow.x, 2.5, 0.15) << x;
      EXPECT_NEAR(seen.flow.y, -1.5, 0.15) << x;
      EXPECT_GT(mean(seen.certainty), 0.3f) << x;
    }
    if (x >= 130) {
      EXPECT_LT(mean(seen.certainty), 0.01f) << x;
    }
  }
}

TEST(SurfaceAlignmentLift, StripesSayNothingAlongThem) {
  const cv::Size size(160, 120);
  cv::Mat stripes(size, CV_8U);
  for (int x = 0; x < size.width; ++x) stripes.col(x) = 128 + 80 * std::sin(0.5 * x);
  const cv::Mat interior(size, CV_32F, cv::Scalar(1));
  for (const FlowObservation& seen : observeFlow(stripes, stripes, interior, pixelGrid(size))) {
    EXPECT_GT(seen.certainty[0][0], 0.8f);
    EXPECT_LT(seen.certainty[1][1], 0.01f);
    EXPECT_NEAR(glm::length(seen.flow), 0, 1e-3);
  }
}

TEST(SurfaceAlignmentLift, OneWrongViewIsOutvotedAndWhatWasKnownStays) {
  const glm::vec2 missing(0.004f, -0.002f), known(0.01f, 0.02f);
  std::vector<std::vector<FlowObservation>> views;
  for (int i = 0; i < 5; ++i) {
    const float c = std::cos(0.3f * i), s = std::sin(0.3f * i);
    const glm::mat2 pixels = 500.0f * glm::mat2(c, s, -s, c);
    views.push_back({{0, 500, pixels, glm::mat2(0.9f), pixels * missing}});
  }
  views[2][0].flow += glm::vec2(8, 5);
  const auto estimates = liftFlow(views, {known, known});
  const glm::vec2 found = glm::inverse(estimates[0].information) * estimates[0].pull;
  EXPECT_NEAR(glm::distance(found, known + missing), 0, 2e-4);
  EXPECT_EQ(estimates[1].information, glm::mat2(0));
}

// Field of constant world direction, as tangent components.
std::vector<glm::vec2> fieldOf(const SurfaceFrames& frames, const glm::vec3& displacement) {
  std::vector<glm::vec2> field;
  for (const glm::mat2x3& t : frames.tangents) field.push_back(displacement * t);
  return field;
}

TEST(SurfaceAlignmentSmooth, HolesTakeTheirNeighboursFieldAcrossTurningTangents) {
  Tube tube;
  for (glm::vec3& p : tube.positions) p = {p.y, p.z, p.x};  // lying: the tangents' reference axis changes round it
  const SurfaceFrames frames = computeSurfaceFrames(tube.topology, tube.positions);
  const auto field = fieldOf(frames, {0.01f, 0, 0});
  std::vector<VertexEstimate> estimates(field.size());
  for (size_t v = 0; v < field.size(); ++v)
    if (v % 3) estimates[v] = {glm::mat2(2), 2.0f * field[v]};
  const auto solved = TangentSmoother(tube.topology, tube.positions, frames, 1).solve(estimates);
  for (size_t v = 0; v < field.size(); ++v) EXPECT_NEAR(glm::distance(solved[v], field[v]), 0, 2e-4) << v;
}

TEST(SurfaceAlignmentSmooth, NothingCertainAnywhereGivesZeroAndFarAwayFades) {
  const Grid grid(40);
  TangentSmoother smoother(grid.topology, grid.positions, grid.frames(), 1);
  std::vector<VertexEstimate> estimates(grid.topology.vertex_count);
  for (const glm::vec2& d : smoother.solve(estimates)) EXPECT_EQ(d, glm::vec2(0));
  for (uint32_t y = 0; y <= 40; ++y) estimates[y * 41] = {glm::mat2(2), glm::vec2(0.02f, 0)};
  const auto solved = smoother.solve(estimates);
  EXPECT_GT(solved[20 * 41 + 1].x, 0.008f);
  EXPECT_LT(solved[20 * 41 + 40].x, 0.2f * solved[20 * 41 + 1].x);
}

TEST(SurfaceAlignmentSmooth, FacesWithoutAreaDoNoHarm) {
  Grid grid(4);
  grid.positions[6] = grid.positions[7];
  grid.topology.face_vertices.push_back({3, 3, 8});
  grid.topology.face_uvs.push_back({3, 3, 8});
  std::vector<VertexEstimate> estimates(grid.topology.vertex_count, {glm::mat2(1), glm::vec2(0.003f)});
  for (const glm::vec2& d : TangentSmoother(grid.topology, grid.positions, grid.frames(), 1).solve(estimates))
    EXPECT_NEAR(glm::distance(d, glm::vec2(0.003f)), 0, 1e-3);
}

TEST(SurfaceAlignmentCharts, CutsAtTheGutterAndInsideKeepsAll) {
  const Grid grid(8);  // 1 m is half of the texture's side: 128 of 256 texels
  const SurfaceFrames frames = grid.frames();
  const ChartLimits limits(grid.topology, frames, 256, 10);
  const auto longest = [&](float length_m) {
    auto field = fieldOf(frames, {0, length_m, 0});
    limits.cut(field);
    return std::pair(glm::length(field[4]), glm::length(field[4 * 9 + 4]));  // at the lower edge, in the middle
  };
  EXPECT_FLOAT_EQ(longest(0.06f).first, 0.06f);  // 7.7 texels
  EXPECT_NEAR(longest(0.2f).first, 10.0 / 128, 1.5 / 128);
  EXPECT_FLOAT_EQ(longest(0.2f).second, 0.2f);
}

TEST(SurfaceAlignmentCharts, DoesNotEnterAnotherChart) {
  Grid grid(4), other(4);  // 128 texels wide, side by side, 4 texels apart
  for (glm::vec2& uv : grid.topology.uvs) uv.x -= 0.25f;
  for (glm::vec2& uv : other.topology.uvs) uv.x += 0.25f + 4.0f / 256;
  const uint32_t first = grid.topology.vertex_count, first_uv = uint32_t(grid.topology.uvs.size());
  for (const glm::vec3& p : other.positions) grid.positions.push_back(p + glm::vec3(3, 0, 0));
  for (const glm::uvec3& f : other.topology.face_vertices) grid.topology.face_vertices.push_back(f + first);
  for (const glm::uvec3& f : other.topology.face_uvs) grid.topology.face_uvs.push_back(f + first_uv);
  grid.topology.uvs.insert(grid.topology.uvs.end(), other.topology.uvs.begin(), other.topology.uvs.end());
  grid.topology.vertex_count *= 2;
  const SurfaceFrames frames = grid.frames();
  auto field = fieldOf(frames, {0.1f, 0, 0});  // 12.8 texels
  ChartLimits(grid.topology, frames, 256, 10).cut(field);
  EXPECT_LT(glm::length(field[4]), 5.0f / 128);  // right edge of the left chart, which meets the other chart
}

AlignedFrame frameOf(float x, float confidence) { return {{glm::vec2(x, -x)}, {confidence}}; }

TEST(SurfaceAlignmentTime, UncertainFramesFollowCertainOnes) {
  std::vector<AlignedFrame> frames(7, frameOf(0.01f, 1));
  frames[3] = frameOf(-0.05f, 0.0f);
  steadyAlignment(frames, false);
  for (const AlignedFrame& frame : frames) EXPECT_NEAR(frame.displacement_m[0].x, 0.01f, 2e-4);
  EXPECT_NEAR(frames[3].displacement_m[0].y, -0.01f, 2e-4);
}

TEST(SurfaceAlignmentTime, LoopsWrapOnly) {
  std::vector<AlignedFrame> loop(6, frameOf(0, 1));
  loop[0] = frameOf(0.5f, 0);
  loop[5] = frameOf(0.01f, 1);
  loop[1] = frameOf(0.03f, 1);
  std::vector<AlignedFrame> line = loop;
  steadyAlignment(loop, true);
  steadyAlignment(line, false);
  EXPECT_NEAR(loop[0].displacement_m[0].x, 0.5f * (loop[1].displacement_m[0].x + loop[5].displacement_m[0].x), 2e-3);
  EXPECT_NEAR(line[0].displacement_m[0].x, line[1].displacement_m[0].x, 4e-3);
}

// Compares with dense elimination.
TEST(SurfaceAlignmentTime, LoopSolvesItsSystem) {
  std::vector<AlignedFrame> frames, before;
  for (int t = 0; t < 5; ++t) frames.push_back(frameOf(0.01f * float(t * t % 7), 0.2f + 0.1f * float(t)));
  before = frames;
  steadyAlignment(frames, true);
  float sum = 0;  // the temporal terms cancel over the loop
  for (int t = 0; t < 5; ++t)
    sum += (before[t].confidence[0] + 1e-3f) * (frames[t].displacement_m[0].x - before[t].displacement_m[0].x);
  EXPECT_NEAR(sum, 0, 1e-6);
}

TEST(SurfaceAlignmentTime, ShortSequencesStay) {
  std::vector<AlignedFrame> one{frameOf(0.02f, 0.3f)}, two{frameOf(0.02f, 1), frameOf(0.02f, 0.1f)};
  steadyAlignment(one, true);
  steadyAlignment(two, true);
  EXPECT_FLOAT_EQ(one[0].displacement_m[0].x, 0.02f);
  EXPECT_NEAR(two[1].displacement_m[0].x, 0.02f, 1e-6);
}

}  // namespace
}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Colour maps of synthetic cameras with known gains and offsets.
#include "bake/texels/colour_calibration.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fourdvt::bake {
namespace {

constexpr int kSide = 96, kTiles = 12;

PinholeCamera cameraAt(double x) {  // looks along -z at the wall in z = 0
  PinholeCamera camera;
  camera.width = camera.height = kSide;
  camera.fx = camera.fy = 80;
  camera.cx = camera.cy = kSide / 2.0;
  camera.cam_from_world =
      glm::dmat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, -1, 0, 0), glm::dvec4(0, 0, -1, 0), glm::dvec4(-x, 0, 2, 1));
  return camera;
}

// Wall of kTiles² squares of 0.1 m; faces 2i and 2i+1 form square i.
struct Wall {
  MeshTopology topology;
  Positions positions;
  Wall() {
    for (int y = 0; y <= kTiles; ++y)
      for (int x = 0; x <= kTiles; ++x) positions.emplace_back(0.1f * x - 0.6f, 0.6f - 0.1f * y, 0.0f);
    topology.vertex_count = uint32_t(positions.size());
    for (uint32_t y = 0; y < kTiles; ++y)
      for (uint32_t x = 0; x < kTiles; ++x) {
        const uint32_t a = y * (kTiles + 1) + x, b = a + 1, c = a + kTiles + 1, d = c + 1;
        topology.face_vertices.push_back({a, c, b});
        topology.face_vertices.push_back({b, c, d});
      }
    topology.face_uvs.assign(topology.face_vertices.size(), {0, 0, 0});
    topology.uvs = {{0, 0}};
  }
};

// Smooth, colourful pattern of the wall.
glm::vec3 wallColour(double x, double y) {
  return {0.5 + 0.25 * std::sin(7 * x + 2 * y), 0.5 + 0.25 * std::sin(5 * y - 3 * x + 1),
          0.5 + 0.25 * std::cos(4 * x + 6 * y)};
}

glm::vec3 inverse(const ColourMap& map, const glm::vec3& colour) {
  return glm::inverse(map.matrix) * (colour - map.offset);
}

// Picture recorded by a camera whose correction is `map`.
Image film(const PinholeCamera& camera, const ColourMap& map) {
  Image image(kSide, kSide, 4, 255);
  const glm::dvec3 centre = camera.centreInWorld();
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double wx = centre.x + 2 * (x + 0.5 - camera.cx) / camera.fx, wy = -2 * (y + 0.5 - camera.cy) / camera.fy;
      const glm::vec3 colour = inverse(map, wallColour(wx, wy));
      for (int c = 0; c < 3; ++c)
        image.at(x, y)[c] = static_cast<uint8_t>(std::min(255.0f, std::max(0.0f, 255 * colour[c] + 0.5f)));
    }
  return image;
}

struct ColourCalibration : ::testing::Test {
  Wall wall;
  std::vector<PinholeCamera> cameras{cameraAt(-0.2), cameraAt(0), cameraAt(0.15), cameraAt(0.3)};
  std::vector<ColourMap> truth{4};  // mean: the identity

  std::vector<Image> pictures() const {
    std::vector<Image> out;
    for (size_t c = 0; c < cameras.size(); ++c) out.push_back(film(cameras[c], truth[c]));
    return out;
  }
  std::vector<ColourMap> solve(const std::vector<Image>& pictures, int repeats = 1) const {
    ColourCalibrator calibrator(cameras.size());
    const std::vector<float> fractions(cameras.size() * wall.topology.faceCount(), 1.0f);
    for (int k = 0; k < repeats; ++k) calibrator.add(cameras, wall.topology, wall.positions, fractions, pictures);
    EXPECT_GT(calibrator.observationCount(), 1000u);
    return calibrator.solve();
  }
  // Largest error over the colours of the wall, in levels of 255.
  static double worstLevels(const ColourMap& map, const ColourMap& expected) {
    double worst = 0;
    for (double x = -0.5; x < 0.5; x += 0.05)
      for (double y = -0.5; y < 0.5; y += 0.05) {
        const glm::vec3 filmed = inverse(expected, wallColour(x, y));
        const glm::vec3 got = map.matrix * filmed + map.offset, want = expected.matrix * filmed + expected.offset;
        for (int c = 0; c < 3; ++c) worst = std::max(worst, 255.0 * std::abs(got[c] - want[c]));
      }
    return worst;
  }
  void expectRecovered(const std::vector<ColourMap>& maps, double levels) const {
    ASSERT_EQ(maps.size(), truth.size());
    for (size_t c = 0; c < maps.size(); ++c) EXPECT_LT(worstLevels(maps[c], truth[c]), levels) << "camera " << c;
  }
  void distort() {
    truth[0].matrix = glm::mat3(1.12f, 0, 0, 0, 1.05f, 0, 0, 0, 0.95f);
    truth[1].matrix = glm::mat3(0.88f, 0, 0, 0, 0.95f, 0, 0, 0, 1.05f);
    truth[2].matrix[1][0] = 0.04f, truth[3].matrix[1][0] = -0.04f;  // green into red
    truth[1].offset = {0.03f, 0, -0.02f};
    truth[3].offset = {-0.03f, 0, 0.02f};
  }
};

TEST_F(ColourCalibration, RecoversGainsCrosstalkAndOffsets) {
  distort();
  const std::vector<ColourMap> identity(4);
  double before = 0;
  for (size_t c = 0; c < 4; ++c) before = std::max(before, worstLevels(identity[c], truth[c]));
  EXPECT_GT(before, 15) << "the test would pass without calibration";
  expectRecovered(solve(pictures()), 2.0);
}

TEST_F(ColourCalibration, CamerasThatAgreeKeepTheirColours) { expectRecovered(solve(pictures()), 0.5); }

TEST_F(ColourCalibration, MeanMapIsTheIdentity) {
  distort();
  truth[0].offset = {0.05f, 0.05f, 0.05f};  // the mean of the truth is no longer the identity
  glm::mat3 matrix(0);
  glm::vec3 offset(0);
  for (const ColourMap& map : solve(pictures())) matrix += map.matrix / 4.0f, offset += map.offset / 4.0f;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(offset[i], 0, 1e-3);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(matrix[i][k], i == k, 1e-3);
  }
}

TEST_F(ColourCalibration, HighlightsInOneCameraDoNotMatter) {
  distort();
  std::vector<Image> filmed = pictures();
  for (int y = 20; y < 76; ++y)  // a tenth of camera 2's picture is overexposed, half of it clipped
    for (int x = 40; x < 56; ++x) std::fill_n(filmed[2].at(x, y), 3, uint8_t(y < 48 ? 255 : 230));
  expectRecovered(solve(filmed), 3.0);
}

TEST_F(ColourCalibration, ReservoirIsBoundedAndDeterministic) {
  distort();
  const std::vector<Image> filmed = pictures();
  ColourCalibrator calibrator(cameras.size());
  const std::vector<float> fractions(cameras.size() * wall.topology.faceCount(), 1.0f);
  for (int k = 0; k < 20; ++k) calibrator.add(cameras, wall.topology, wall.positions, fractions, filmed);
  EXPECT_EQ(calibrator.observationCount(), 60000u);
  const auto a = solve(filmed, 20), b = solve(filmed, 20);
  for (size_t c = 0; c < a.size(); ++c) EXPECT_EQ(a[c].matrix, b[c].matrix);
  expectRecovered(a, 2.0);
}

TEST_F(ColourCalibration, CameraThatSeesNothingKeepsItsColours) {
  distort();
  std::vector<Image> filmed = pictures();
  for (size_t i = 3; i < filmed[3].pixels.size(); i += 4) filmed[3].pixels[i] = 0;
  const auto maps = solve(filmed);
  EXPECT_EQ(maps[3].matrix, glm::mat3(1));
  EXPECT_EQ(maps[3].offset, glm::vec3(0));
  EXPECT_NE(maps[0].matrix, glm::mat3(1));
}

TEST(ColourCalibrator, NothingObservedIsTheIdentity) {
  for (const ColourMap& map : ColourCalibrator(3).solve()) {
    EXPECT_EQ(map.matrix, glm::mat3(1));
    EXPECT_EQ(map.offset, glm::vec3(0));
  }
}

}  // namespace
}  // namespace fourdvt::bake

// SPDX-License-Identifier: Apache-2.0
// Colours of a surface's vertices against known ones: visibility, averaging, filling.
#include <gtest/gtest.h>

#include "encode/surfaces.h"

namespace fourdvt::encode {
namespace {

constexpr uint16_t kOne = 65535;

// Camera of 200 × 200 pixels that looks at the origin from `z` metres.
PinholeCamera cameraAt(double z) {
  PinholeCamera camera;
  camera.width = camera.height = 200;
  camera.fx = camera.fy = 200;
  camera.cx = camera.cy = 100;
  // COLMAP's axes: y down, z forward.
  const glm::dmat3 rotation = z > 0 ? glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, -1) : glm::dmat3(-1, 0, 0, 0, -1, 0, 0, 0, 1);
  camera.cam_from_world = glm::dmat4(rotation);
  camera.cam_from_world[3] = glm::dvec4(rotation * glm::dvec3(0, 0, -z), 1);
  return camera;
}

Image plain(glm::u8vec3 colour, uint8_t alpha = 255) {
  Image out(200, 200, 4);
  for (size_t i = 0; i < out.pixels.size(); i += 4) {
    for (int c = 0; c < 3; ++c) out.pixels[i + size_t(c)] = colour[c];
    out.pixels[i + 3] = alpha;
  }
  return out;
}

// Adds a square of n × n cells round (0, 0, z), facing +Z, or -Z with `turned`.
void addSquare(TriangleMesh& mesh, double z, double side, uint32_t n, bool turned = false) {
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  for (uint32_t y = 0; y <= n; ++y)
    for (uint32_t x = 0; x <= n; ++x)
      mesh.positions.emplace_back(side * (x / double(n) - 0.5), side * (y / double(n) - 0.5), z);
  for (uint32_t y = 0; y < n; ++y) {
    for (uint32_t x = 0; x < n; ++x) {
      const uint32_t a = first + y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.faces.push_back(turned ? glm::uvec3(a, c, b) : glm::uvec3(a, b, c));
      mesh.faces.push_back(turned ? glm::uvec3(b, c, d) : glm::uvec3(b, d, c));
    }
  }
}

TEST(VertexColours, EachSideHasTheColourOfItsCameraLinear) {
  TriangleMesh mesh;
  addSquare(mesh, 0.05, 0.5, 8);
  const size_t front = mesh.positions.size();
  addSquare(mesh, -0.05, 0.5, 8, true);
  const std::vector<Image> pictures{plain({255, 0, 188}), plain({0, 128, 0})};
  const auto colours = vertexColours(mesh, {cameraAt(2), cameraAt(-2)}, pictures);
  ASSERT_EQ(colours.size(), mesh.positions.size());
  for (size_t v = 0; v < colours.size(); ++v) {
    // sRGB 188 is linear 0.5029, 128 is 0.2159.
    const glm::ivec3 expected = v < front ? glm::ivec3(kOne, 0, 32957) : glm::ivec3(0, 14146, 0);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(colours[v][c], expected[c], 8) << v;
  }
}

TEST(VertexColours, AShieldHidesWhatLiesBehindIt) {
  TriangleMesh mesh;
  addSquare(mesh, 0, 0.8, 16);
  const size_t wall = mesh.positions.size();
  addSquare(mesh, 0.5, 0.4, 8);
  // The first camera sees both, and its picture is red on the shield: the wall must not take this colour.
  const PinholeCamera camera = cameraAt(2);
  Image picture = plain({0, 0, 255});
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) {
      const double half = 200 * 0.2 / 1.5;
      if (std::abs(x + 0.5 - 100) < half && std::abs(y + 0.5 - 100) < half) {
        picture.at(x, y)[0] = 255;
        picture.at(x, y)[2] = 0;
      }
    }
  }
  const auto colours = vertexColours(mesh, {camera}, std::vector<Image>{picture});
  const auto redShare = [&](size_t v) { return colours[v][0] / double(colours[v][0] + colours[v][2]); };
  EXPECT_GT(redShare(wall + 40), 0.99) << "the middle of the shield";
  double most = 0;
  for (size_t v = 0; v < wall; ++v) most = std::max(most, redShare(v));
  // The square over which a vertex averages extends past the shield's outline by a third of an edge.
  EXPECT_LT(most, 0.6) << "a vertex behind the shield is red";
  EXPECT_LT(redShare(8 * 17 + 8), 0.01) << "the wall's middle is filled from beside the shield";
}

TEST(VertexColours, PixelsWithoutThePerformerDoNotCount) {
  TriangleMesh mesh;
  addSquare(mesh, 0, 0.5, 4);
  const std::vector<Image> pictures{plain({255, 255, 255}, 127), plain({255, 0, 0})};
  const auto colours = vertexColours(mesh, {cameraAt(2), cameraAt(3)}, pictures);
  for (const glm::u16vec3& colour : colours) EXPECT_EQ(colour, glm::u16vec3(kOne, 0, 0));
}

TEST(VertexColours, UnseenSurfacesAreMidGrey) {
  TriangleMesh mesh;
  addSquare(mesh, 0, 0.5, 2, true);
  const auto colours = vertexColours(mesh, {cameraAt(2)}, std::vector<Image>{plain({255, 0, 0})});
  for (const glm::u16vec3& colour : colours)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(colour[c], 14025, 8);
}

}  // namespace
}  // namespace fourdvt::encode

// SPDX-License-Identifier: Apache-2.0
// Visibility and resampling against geometry that can be worked out by hand.
#include "bake/gpu_capture.h"
#include "bake/resample.h"
#include "bake/visibility.h"
#include "gl_fixture.h"

namespace fourdvt::bake {
namespace {

constexpr int kPictureSide = 128;

// A 2 × 2 m wall in z = 0 that faces +Z, UVs over the whole texture (v down), made of two triangles; and a shield of
// one triangle at z = 1 that covers the wall's right part for the camera straight ahead.
struct Wall {
  MeshTopology topology;
  Positions positions{{-1, 1, 0}, {1, 1, 0}, {1, -1, 0}, {-1, -1, 0}};
  explicit Wall(bool shield) {
    topology.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    topology.face_vertices = {{0, 2, 1}, {0, 3, 2}};
    topology.face_uvs = topology.face_vertices;
    if (shield) {
      positions.insert(positions.end(), {{-0.1f, -4, 1}, {4, 0, 1}, {-0.1f, 4, 1}});
      topology.face_vertices.push_back({4, 5, 6});
      topology.face_uvs.push_back({0, 0, 0});
    }
    topology.vertex_count = static_cast<uint32_t>(positions.size());
  }
};

// Red grows with x, green with y; opaque.
Image gradient() {
  Image image(kPictureSide, kPictureSide, 4, 255);
  for (int y = 0; y < kPictureSide; ++y)
    for (int x = 0; x < kPictureSide; ++x) {
      image.at(x, y)[0] = static_cast<uint8_t>(2 * x);
      image.at(x, y)[1] = static_cast<uint8_t>(2 * y);
      image.at(x, y)[2] = 0;
    }
  return image;
}

struct BakeStages : testing::GlFixture {
  // Straight ahead, and from the left at 45°.
  std::vector<PinholeCamera> cameras{testing::lookAt({0, 0, 4}, {0, 0, 0}, kPictureSide, kPictureSide, 200),
                                     testing::lookAt({-3, 0, 3}, {0, 0, 0}, kPictureSide, kPictureSide, 200)};

  GpuCapture capture(const Wall& wall, const std::vector<Image>& pictures) {
    auto made = GpuCapture::create(*device, cameras, wall.topology, false);
    EXPECT_TRUE(made) << (made ? "" : made.error().message);
    std::vector<PictureCrop> crops;
    for (size_t c = 0; c < cameras.size(); ++c) crops.push_back(cropPicture(cameras[c], wall.positions, pictures[c]));
    GpuCapture out = made.take();
    out.setFrame(*device, wall.positions, crops);
    return out;
  }

  std::vector<float> shares(const Wall& wall, const std::vector<Image>& pictures) {
    const GpuCapture on_gpu = capture(wall, pictures);
    auto visibility = Visibility::create(*device, on_gpu);
    EXPECT_TRUE(visibility) << (visibility ? "" : visibility.error().message);
    return visibility.value().measure(*device, on_gpu).take();
  }
};

TEST_F(BakeStages, UncoveredFacesAreSeenWhole) {
  const std::vector<float> s = shares(Wall(false), {gradient(), gradient()});
  ASSERT_EQ(s.size(), 4u);
  for (float share : s) EXPECT_FLOAT_EQ(share, 1);
}

TEST_F(BakeStages, ShieldHidesItsShadowFromOneCamera) {
  const std::vector<float> s = shares(Wall(true), {gradient(), gradient()});
  ASSERT_EQ(s.size(), 6u);
  // For the camera ahead the shield ends at x = -0.1 * 4/3 = -0.133 on the wall. Face 0 is the upper right half: of its
  // corners (-1, 1), (1, -1), (1, 1), edge middles (0, 0), (1, 0), (0, 1) and centroid (1/3, 1/3) one is clear.
  EXPECT_NEAR(s[0], 1 / 7.0, 0.01);
  EXPECT_NEAR(s[1], 4 / 7.0, 0.01);  // lower left: (-1, 1), (-1, -1), (-1, 0) and (-1/3, -1/3)
  EXPECT_NEAR(s[2], 1 / 7.0, 0.01) << "of the shield itself only the middle of the left edge lies in the picture";
}

TEST_F(BakeStages, MatteHides) {
  Image transparent = gradient();
  for (size_t i = 3; i < transparent.pixels.size(); i += 4) transparent.pixels[i] = 0;
  const std::vector<float> s = shares(Wall(false), {transparent, gradient()});
  EXPECT_FLOAT_EQ(s[0], 0);
  EXPECT_FLOAT_EQ(s[2], 1);
}

TEST_F(BakeStages, TexelShowsThePixelItsPointProjectsTo) {
  const Wall wall(false);
  const GpuCapture on_gpu = capture(wall, {gradient(), gradient()});
  auto resampler = Resampler::create(*device, on_gpu, {64, 32});
  ASSERT_TRUE(resampler) << resampler.error().message;
  auto layers = resampler.value().resample(*device, on_gpu, {0, 0, 1, package::kNoCamera});
  ASSERT_TRUE(layers) << layers.error().message;
  for (int layer = 0; layer < 2; ++layer) {
    const Image& image = layers.value()[layer];
    const double size = image.width;
    int empty = 0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const uint8_t* p = image.at(x, y);
        if (p[3] == 0) {
          ++empty;
          continue;
        }
        const glm::dvec3 point(2 * (x + 0.5) / size - 1, 1 - 2 * (y + 0.5) / size, 0);
        const glm::dvec3 pixel = cameras[layer].project(point);
        ASSERT_NEAR(p[0], 2 * (pixel.x - 0.5), 1.5) << layer << " " << x << " " << y;
        ASSERT_NEAR(p[1], 2 * (pixel.y - 0.5), 1.5) << layer << " " << x << " " << y;
      }
    }
    // Layer 2 has no camera for the lower left half.
    EXPECT_NEAR(empty, layer == 0 ? 0 : size * size / 2, size);
  }
}

TEST(PictureCrop, BackdropColourDoesNotReachTheEdge) {
  // A red square on a green screen whose matte edge is soft and whose colour bleeds two pixels inwards.
  Image image(64, 64, 4);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const int depth = std::min({x - 15, 48 - x, y - 15, 48 - y});  // pixels inside the square
      const double share = depth <= 0 ? 0 : depth == 1 ? 0.6 : depth == 2 ? 0.9 : 1;
      image.at(x, y)[0] = static_cast<uint8_t>(200 * share);
      image.at(x, y)[1] = static_cast<uint8_t>(200 * (1 - share));
      image.at(x, y)[3] = static_cast<uint8_t>(depth <= 0 ? 0 : depth == 1 ? 153 : 255);
    }
  replaceEdgeColours(image);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      if (image.at(x, y)[3] > 0) {
        ASSERT_GE(image.at(x, y)[0], 199) << x << " " << y;
        ASSERT_LE(image.at(x, y)[1], 1) << x << " " << y;
      }
}

}  // namespace
}  // namespace fourdvt::bake

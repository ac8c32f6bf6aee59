// SPDX-License-Identifier: Apache-2.0
// Visibility and resampling on analytic geometry.
#include "bake/texels/frame_baker.h"
#include "bake/texels/gpu_capture.h"
#include "bake/texels/resample.h"
#include "gl_fixture.h"
#include "lab/labels/per_texel.h"

namespace fourdvt::bake {
namespace {

constexpr int kPictureSide = 128;

// 2 × 2 m wall in z = 0 that faces +Z, UVs over the whole texture (v down), two triangles; and a shield of one triangle
// at z = 1 that hides the wall's right part from the frontal camera.
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

// Red rises with x, green with y; opaque.
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
  // One camera in front, and one from the left at 45°.
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
  // For the frontal camera the shield ends at x = -0.1 * 4/3 = -0.133 on the wall. Face 0 is the upper right half; of
  // its corners (-1, 1), (1, -1), (1, 1), edge midpoints (0, 0), (1, 0), (0, 1) and centroid (1/3, 1/3), one is
  // visible.
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

// Small texels use coarse mipmaps, which extend beyond the surface's part of the picture.
TEST_F(BakeStages, AFrameDoesNotDependOnTheFramesBefore) {
  Wall wall(false);
  const Positions small{{-0.3f, 0.3f, 0}, {0.3f, 0.3f, 0}, {0.3f, -0.3f, 0}, {-0.3f, -0.3f, 0}};
  Positions aside = small;
  for (glm::vec3& p : aside) p.x += 0.55f;
  const auto layerAfter = [&](const std::vector<Positions>& poses) {
    auto on_gpu = GpuCapture::create(*device, cameras, wall.topology, true);
    EXPECT_TRUE(on_gpu.ok());
    ResampleOptions options;
    options.filter = ResampleFilter::Mipmap;
    auto resampler = Resampler::create(*device, on_gpu.value(), {1}, options, {});
    EXPECT_TRUE(resampler.ok());
    for (const Positions& pose : poses) {
      std::vector<PictureCrop> crops;
      const Image picture = &pose == &poses.back() ? gradient() : Image(kPictureSide, kPictureSide, 4, 255);
      for (const PinholeCamera& camera : cameras) crops.push_back(cropPicture(camera, pose, picture));
      on_gpu.value().setFrame(*device, pose, crops);
    }
    return resampler.value().resample(*device, on_gpu.value(), {0, 0}).take()[0].pixels;
  };
  const auto alone = layerAfter({small});
  EXPECT_EQ(alone, (std::vector<uint8_t>{0, 0, 0, 0})) << "half of what the one texel spans is not the surface's";
  EXPECT_EQ(layerAfter({aside, small}), alone);
  EXPECT_EQ(layerAfter({wall.positions, small}), alone);
}

TEST_F(BakeStages, TexelShowsThePixelItsPointProjectsTo) {
  const Wall wall(false);
  const GpuCapture on_gpu = capture(wall, {gradient(), gradient()});
  auto resampler = Resampler::create(*device, on_gpu, {64, 32}, {}, {});
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

TEST_F(BakeStages, EveryFilterReproducesALinearPicture) {
  const Wall wall(false);
  const GpuCapture on_gpu = capture(wall, {gradient(), gradient()});
  for (ResampleFilter filter : {ResampleFilter::Bilinear, ResampleFilter::Mipmap, ResampleFilter::Bicubic}) {
    ResampleOptions options;
    options.filter = filter;
    auto resampler = Resampler::create(*device, on_gpu, {96}, options, {});
    ASSERT_TRUE(resampler) << resampler.error().message;
    const Image image = resampler.value().resample(*device, on_gpu, {0, 0}).take()[0];
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x) {
        const glm::dvec3 pixel = cameras[0].project({2 * (x + 0.5) / 96 - 1, 1 - 2 * (y + 0.5) / 96, 0});
        ASSERT_NEAR(image.at(x, y)[0], 2 * (pixel.x - 0.5), 1.5) << int(filter) << " " << x << " " << y;
      }
  }
}

// Left half opaque red; right half green with alpha 0.4, which is background by the matte's threshold.
Image redBesideVeil() {
  Image image(kPictureSide, kPictureSide, 4);
  for (int y = 0; y < kPictureSide; ++y)
    for (int x = 0; x < kPictureSide; ++x) {
      uint8_t* p = image.at(x, y);
      const bool left = x < kPictureSide / 2;
      p[0] = left ? 200 : 0, p[1] = left ? 0 : 80, p[2] = 0, p[3] = left ? 255 : 102;  // premultiplied
    }
  return image;
}

struct MatteEdge : BakeStages {
  Image draw(const ResampleOptions& options) {
    const Wall wall(false);
    GpuCapture on_gpu = capture(wall, {gradient(), gradient()});
    PictureCrop crop{{0, 0, kPictureSide, kPictureSide, 1, 6}, redBesideVeil().pixels};
    on_gpu.setFrame(*device, wall.positions, {crop, crop});
    Resampler resampler = Resampler::create(*device, on_gpu, {256}, options, {}).take();
    return resampler.resample(*device, on_gpu, {0, 0}).take()[0];
  }
  // Number of resampled texels in the middle row, and their maximum green.
  static std::pair<int, int> middleRow(const Image& image) {
    int count = 0, green = 0;
    for (int x = 0; x < image.width; ++x) {
      const uint8_t* p = image.at(x, image.height / 2);
      if (p[3]) ++count, green = std::max(green, int(p[1]));
    }
    return {count, green};
  }
};

TEST_F(MatteEdge, BicubicGivesBackgroundNoWeight) {
  ResampleOptions options;
  options.matte_threshold = 0.5f;
  options.matte_pixels = 0;
  options.filter = ResampleFilter::Bilinear;
  EXPECT_GT(middleRow(draw(options)).second, 5) << "bilinear mixes the veil in: the test can fail";
  options.filter = ResampleFilter::Bicubic;
  options.matte_threshold = 0.75f;
  EXPECT_EQ(middleRow(draw(options)).second, 0);
}

TEST_F(MatteEdge, TexelsKeepTheirDistanceFromBackground) {
  // 256 texels over 100 pixels: the edge (half a pixel's ramp left of the threshold) moves by matte_pixels * 2.56.
  ResampleOptions options;
  options.matte_threshold = 0.5f;
  options.matte_pixels = 0;
  const int plain = middleRow(draw(options)).first;
  options.matte_pixels = 3;
  const auto [kept, green] = middleRow(draw(options));
  EXPECT_NEAR(plain - kept, 3 * 2.56, 1.5);
  EXPECT_EQ(green, 0);
}

TEST_F(BakeStages, ColourMapsApplyToTheirCameras) {
  const Wall wall(false);
  const GpuCapture on_gpu = capture(wall, {gradient(), gradient()});
  std::vector<ColourMap> maps(2);
  maps[1].matrix[0] = {0.5f, 0, 0.25f};  // red: half to red, a quarter to blue
  maps[1].offset = {0.1f, 0, 0};
  auto resampler = Resampler::create(*device, on_gpu, {64, 64}, {}, maps);
  ASSERT_TRUE(resampler) << resampler.error().message;
  const std::vector<Image> layers = resampler.value().resample(*device, on_gpu, {0, 0, 1, 1}).take();
  for (int layer = 0; layer < 2; ++layer)
    for (int x = 4; x < 64; x += 8) {
      const double red = 2 * (cameras[layer].project({2 * (x + 0.5) / 64 - 1, 1 - 2 * 32.5 / 64, 0}).x - 0.5);
      const uint8_t* p = layers[layer].at(x, 32);
      EXPECT_NEAR(p[0], layer ? 0.5 * red + 25.5 : red, 1.5) << layer << " " << x;
      EXPECT_NEAR(p[2], layer ? 0.25 * red : 0, 1.5) << layer << " " << x;
    }
  EXPECT_FALSE(Resampler::create(*device, on_gpu, {64}, {}, {ColourMap()})) << "one map for two cameras";
}

// Camera 0 ranks first, but the shield hides the wall right of x = -0.133 from it; camera 1 sees the whole wall.
TEST_F(BakeStages, PerTexelTakesTheNextCameraThatSeesTheTexel) {
  const Wall wall(true);
  const GpuCapture on_gpu = capture(wall, {gradient(), gradient()});
  auto resampler = Resampler::create(*device, on_gpu, {64, 64}, {}, {});
  ASSERT_TRUE(resampler) << resampler.error().message;
  constexpr uint8_t kNone = package::kNoCamera;
  auto layers = lab::resamplePerTexel(resampler.value(), *device, on_gpu, {0, 0, kNone, 1, 1, kNone});
  ASSERT_TRUE(layers) << layers.error().message;
  for (int x = 1; x < 63; ++x) {
    const double wall_x = 2 * (x + 0.5) / 64 - 1;
    if (std::abs(wall_x + 0.133) < 0.1) continue;  // within the minimum distance from the contour
    const bool covered = wall_x > -0.133;
    const uint8_t *first = layers.value()[0].at(x, 32), *second = layers.value()[1].at(x, 32);
    const glm::dvec3 point(wall_x, 1 - 2 * 32.5 / 64, 0);
    ASSERT_EQ(first[3], 255) << x;
    EXPECT_NEAR(first[0], 2 * (cameras[covered].project(point).x - 0.5), 1.5) << x;
    ASSERT_EQ(second[3], covered ? 0 : 255) << x;
    if (covered) continue;
    EXPECT_NEAR(second[0], 2 * (cameras[1].project(point).x - 0.5), 1.5) << x;
  }
}

TEST_F(BakeStages, PerTexelFollowsTheRanksNotTheCamerasNumbers) {
  const Wall wall(true);
  const GpuCapture on_gpu = capture(wall, {gradient(), gradient()});
  Resampler resampler = Resampler::create(*device, on_gpu, {64, 64}, {}, {}).take();
  constexpr uint8_t kNone = package::kNoCamera;
  const auto layers = lab::resamplePerTexel(resampler, *device, on_gpu, {1, 1, kNone, 0, 0, kNone}).take();
  for (int l = 0; l < 2; ++l)
    for (int x = 2; x < 24; x += 3) {
      const glm::dvec3 point(2 * (x + 0.5) / 64 - 1, 1 - 2 * 32.5 / 64, 0);
      EXPECT_NEAR(layers[l].at(x, 32)[0], 2 * (cameras[1 - l].project(point).x - 0.5), 1.5) << l << " " << x;
    }
}

TEST(PictureCrop, BackdropColourDoesNotReachTheEdge) {
  // A red square on a green screen with a soft matte edge and colours that bleed two pixels inwards.
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

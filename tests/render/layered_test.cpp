// SPDX-License-Identifier: Apache-2.0
// The layered pass against LVDT Eq. 3-4 in double precision, colour conversion, addressing, alignment, shadow.
#include <cmath>
#include <cstring>

#include "expected.h"
#include "gl_fixture.h"

namespace fourdvt::render {
namespace {

using testing::Scene;
using testing::Still;

class Layered : public testing::GlFixture {};

using testing::constantLayers;
using testing::eq3;
using testing::expectColor;
using testing::kTolerance;
using testing::plainOptions;
using testing::pointOnPlane;

const std::vector<glm::dvec3> kColors = {{230, 30, 60}, {20, 200, 90}, {70, 40, 250}};

void checkBlend(const Image& picture, const Scene& scene, const PinholeCamera& view, int layers,
                const RecipeOptions& options) {
  for (const auto& [x, y] : {std::pair(40, 50), {100, 100}, {150, 60}, {60, 160}, {130, 140}, {99, 35}}) {
    const glm::dvec3 point = pointOnPlane(view, x, y);
    glm::dvec3 color(0);
    double sum = 0;
    for (int rank = 0; rank < layers; ++rank) {
      const double weight = eq3(scene.character.cameras[scene.labels[rank * 2]], view, point, options);
      color += weight * kColors[rank];
      sum += weight;
    }
    expectColor(picture, x, y, color / sum, kTolerance);
  }
}

TEST_F(Layered, blendsAsEquation3And4) {
  const PinholeCamera view = testing::lookAt({0.3, 1.2, 3}, {0, 1, 0}, 200, 200, 250);
  for (int layers = 1; layers <= 3; ++layers) {
    Scene scene = testing::quadScene({0, 1}, 1.2f);
    scene.setLayers(layers, 32);
    for (int rank = 0; rank < layers; ++rank)
      for (uint32_t face = 0; face < 2; ++face) scene.setLabel(rank, face, static_cast<uint8_t>(2 - rank));
    Still still(*device, scene, PictureTextures::Kind::Rgba);
    still.uploadRgba(constantLayers(scene, {kColors.begin(), kColors.begin() + layers}));
    for (const auto& [facing, viewing] : {std::pair(1.0f, 1.0f), {4.0f, 3.0f}, {1.0f, 8.0f}, {6.0f, 1.0f}}) {
      RecipeOptions options = plainOptions();
      options.facing_exponent = facing;
      options.view_exponent = viewing;
      for (int samples : {0, 4}) {
        options.samples = samples;
        const Image picture = still.draw(viewFromCamera(view), options);
        remember(picture);
        checkBlend(picture, scene, view, layers, options);
      }
    }
  }
}

TEST_F(Layered, ignoresEmptyRanksAndFallsBackToTheFirst) {
  Scene scene = testing::quadScene({0, 1}, 1.2f);
  scene.setLayers(2, 32);
  scene.setLabel(0, 0, 0);  // face 0: one camera; face 1: none at all
  Still still(*device, scene, PictureTextures::Kind::Rgba);
  still.uploadRgba(constantLayers(scene, {kColors[0], kColors[1]}));
  const PinholeCamera view = testing::lookAt({0, 1, 3}, {0, 1, 0}, 64, 64, 70);
  const Image picture = still.draw(viewFromCamera(view), plainOptions());
  remember(picture);
  for (const auto& [x, y] : {std::pair(20, 45), {45, 20}, {32, 32}}) expectColor(picture, x, y, kColors[0], 0.5);
}

TEST_F(Layered, fallsBackWhereNoCameraFacesTheView) {
  Scene scene = testing::quadScene({0, 1}, 1.2f);
  for (PinholeCamera& camera : scene.character.cameras) camera = testing::lookAt({0.1, 1.2, -3}, {0, 1, 0}, 8, 8, 9);
  scene.setLayers(2, 32);
  for (int rank = 0; rank < 2; ++rank)
    for (uint32_t face = 0; face < 2; ++face) scene.setLabel(rank, face, static_cast<uint8_t>(rank));
  Still still(*device, scene, PictureTextures::Kind::Rgba);
  still.uploadRgba(constantLayers(scene, {kColors[0], kColors[1]}));
  const PinholeCamera view = testing::lookAt({0, 1, 3}, {0, 1, 0}, 64, 64, 70);
  const Image picture = still.draw(viewFromCamera(view), plainOptions());
  expectColor(picture, 30, 40, kColors[0], 0.5);
}

TEST_F(Layered, feathersACameraLinearlyOverOneTriangle) {
  // Camera 1 is in face 0 only: its mask is 1 at vertex 1 (bottom left), 0 on the diagonal.
  Scene scene = testing::quadScene({0, 1}, 1.0f);
  scene.setLayers(2, 32);
  scene.setLabel(0, 0, 0);
  scene.setLabel(1, 0, 1);
  scene.setLabel(0, 1, 0);
  Still still(*device, scene, PictureTextures::Kind::Rgba);
  still.uploadRgba(constantLayers(scene, {{250, 250, 250}, {10, 10, 10}}));
  const PinholeCamera view = testing::lookAt({0, 1, 3}, {0, 1, 0}, 300, 300, 440);
  const Image picture = still.draw(viewFromCamera(view), plainOptions());
  remember(picture);
  double least = 1, most = 0;
  for (int i = 10; i < 290; i += 7) {
    const int x = i, y = 299 - i;  // from bottom left to top right
    const glm::dvec3 p = pointOnPlane(view, x, y);
    const double mask = std::clamp(-(p.x + p.y - 1) / 2, 0.0, 1.0);  // 1 at (-1, 0), 0 on the diagonal
    const double w0 = eq3(scene.character.cameras[0], view, p, plainOptions());
    const double w1 = mask * eq3(scene.character.cameras[1], view, p, plainOptions());
    expectColor(picture, x, y, glm::dvec3((250 * w0 + 10 * w1) / (w0 + w1)), kTolerance);
    least = std::min(least, mask);
    most = std::max(most, mask);
  }
  EXPECT_EQ(least, 0.0);
  EXPECT_GT(most, 0.9);
}

glm::dvec3 bt709Reference(int y, int u, int v) {
  const double luma = (y - 16) / 219.0, cb = (u - 128) / 224.0, cr = (v - 128) / 224.0;
  const double kr = 0.2126, kb = 0.0722, kg = 1 - kr - kb;
  const double r = luma + 2 * (1 - kr) * cr, b = luma + 2 * (1 - kb) * cb, g = (luma - kr * r - kb * b) / kg;
  return 255.0 * glm::clamp(glm::dvec3(r, g, b), 0.0, 1.0);
}

// One layer, with camera 0 as label of both faces.
Scene quadOfOneCamera(float half_size) {
  Scene scene = testing::quadScene({0, 1}, half_size);
  scene.setLayers(1, 16);
  scene.setLabel(0, 0, 0);
  scene.setLabel(0, 1, 0);
  return scene;
}

TEST_F(Layered, convertsBt709LimitedRange) {
  const Scene scene = quadOfOneCamera(1.2f);
  Still still(*device, scene, PictureTextures::Kind::I420);
  const PinholeCamera view = testing::lookAt({0, 1, 3}, {0, 1, 0}, 16, 16, 20);
  const int colors[][3] = {{16, 128, 128}, {235, 128, 128}, {126, 128, 128}, {63, 102, 240}, {173, 42, 26},
                           {32, 240, 118}, {100, 90, 160},  {200, 140, 120}, {1, 20, 250},   {254, 255, 3}};
  for (const auto& [y, u, v] : colors) {
    const std::vector<uint8_t> luma(20 * 16, static_cast<uint8_t>(y));  // padded rows
    const std::vector<uint8_t> cb(64, static_cast<uint8_t>(u)), cr(64, static_cast<uint8_t>(v));
    uploadPicture(*device, still.picture, {16, 16, luma.data(), cb.data(), cr.data(), 20, 8, 8});
    const Image picture = still.draw(viewFromCamera(view), plainOptions());
    remember(picture);
    expectColor(picture, 8, 5, bt709Reference(y, u, v), 1.0);
  }
}

uint8_t noise(int x, int y, int channel) {
  return static_cast<uint8_t>(
      (static_cast<uint32_t>(x * 7919 + y * 104729 + channel * 1299709 + 12345) * 2654435761u) >> 24);
}

// View with `scale` pixels per texel of the quad's 16-texel layer.
PinholeCamera texelView(int scale) {
  PinholeCamera view = testing::lookAt({0, 1, 4}, {0, 1, 0}, 16 * scale, 16 * scale, 32.0 * scale);
  return view;  // quad of half 1 at distance 4: 2 m = 16 * scale pixels
}

TEST_F(Layered, addressesTexelsOfALayerExactly) {
  Scene scene = testing::quadScene({0, 1}, 1.0f);
  scene.setLayers(2, 16);
  scene.rendition.width = 64;
  scene.rendition.height = 40;
  scene.rendition.layers = {{32, 4, 16, 16}, {6, 22, 16, 16}};
  for (int rank = 0; rank < 2; ++rank)
    for (uint32_t face = 0; face < 2; ++face) scene.setLabel(rank, face, static_cast<uint8_t>(rank));
  Still still(*device, scene, PictureTextures::Kind::Rgba);
  Image tiles(64, 40, 4, 255);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c) tiles.at(x, y)[c] = noise(x, y, c);
  still.uploadRgba(tiles);
  RecipeOptions options = plainOptions();
  options.debug = DebugView::Layer;
  for (options.debug_layer = 0; options.debug_layer < 2; ++options.debug_layer) {
    const package::Rect rect = scene.rendition.layers[options.debug_layer];
    const Image once = still.draw(viewFromCamera(texelView(1)), options);
    remember(once);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) {
        const uint8_t* texel = tiles.at(rect.x + x, rect.y + y);
        expectColor(once, x, y, {texel[0], texel[1], texel[2]}, 1.0);
      }
    // Magnified, the outermost half texel repeats the border texel: nothing bleeds in from outside the rectangle.
    const Image large = still.draw(viewFromCamera(texelView(8)), options);
    for (const auto& [x, y] : {std::pair(0, 0), {15, 0}, {0, 15}, {15, 15}}) {
      const uint8_t* texel = tiles.at(rect.x + x, rect.y + y);
      expectColor(large, x ? 127 : 0, y ? 127 : 0, {texel[0], texel[1], texel[2]}, 1.0);
    }
  }
}

TEST_F(Layered, addressesPlanesOfALayerExactly) {
  Scene scene = testing::quadScene({0, 1}, 1.0f);
  scene.setLayers(1, 16);
  scene.rendition.width = 32;
  scene.rendition.height = 32;
  scene.rendition.layers = {{8, 12, 16, 16}};
  scene.setLabel(0, 0, 0);
  scene.setLabel(0, 1, 0);
  std::vector<uint8_t> luma(32 * 32), cb(16 * 16), cr(16 * 16);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) luma[y * 32 + x] = static_cast<uint8_t>(60 + noise(x, y, 0) / 2);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      const bool inside = x >= 4 && x < 12 && y >= 6 && y < 14;
      cb[y * 16 + x] = inside ? 118 : 255;
      cr[y * 16 + x] = inside ? 139 : 0;
    }
  Still still(*device, scene, PictureTextures::Kind::I420);
  uploadPicture(*device, still.picture, {32, 32, luma.data(), cb.data(), cr.data(), 32, 16, 16});
  const Image picture = still.draw(viewFromCamera(texelView(1)), plainOptions());
  remember(picture);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) expectColor(picture, x, y, bt709Reference(luma[(12 + y) * 32 + 8 + x], 118, 139), 1.0);
}

TEST_F(Layered, aPointLandsOnTheProjectedPixel) {
  PinholeCamera view = testing::lookAt({1.1, 1.6, 2.4}, {0.1, 0.9, 0}, 160, 120, 180);
  view.cx = 71.3;
  view.cy = 66.8;
  view.fy = 171;
  for (const glm::vec2 at : {glm::vec2(0.1, 0.9), {-0.35, 1.1}, {0.4, 0.7}}) {
    Scene scene = testing::quadScene(at, 0.02f);
    scene.setLayers(1, 16);
    scene.setLabel(0, 0, 0);
    scene.setLabel(0, 1, 0);
    Still still(*device, scene, PictureTextures::Kind::Rgba);
    still.uploadRgba(constantLayers(scene, {kColors[0]}));
    RecipeOptions options = plainOptions();
    options.samples = 4;
    const Image picture = still.draw(viewFromCamera(view), options);
    remember(picture);
    glm::dvec2 centroid(0);
    double area = 0;
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 160; ++x) {
        const double coverage = picture.at(x, y)[3] / 255.0;
        centroid += coverage * glm::dvec2(x + 0.5, y + 0.5);
        area += coverage;
      }
    ASSERT_GT(area, 3.0);
    centroid /= area;
    const glm::dvec3 expected = view.project({at.x, at.y, 0});
    EXPECT_NEAR(centroid.x, expected.x, 0.2);
    EXPECT_NEAR(centroid.y, expected.y, 0.2);
  }
}

TEST_F(Layered, edgesArePremultipliedAndTheBackgroundStays) {
  const Scene scene = quadOfOneCamera(0.5f);
  Still still(*device, scene, PictureTextures::Kind::Rgba);
  still.uploadRgba(constantLayers(scene, {{255, 255, 255}}));
  RecipeOptions options = plainOptions();
  options.samples = 4;
  const PinholeCamera view = testing::lookAt({0.7, 1.4, 3}, {0, 1, 0}, 64, 64, 70);
  const Image clear = still.draw(viewFromCamera(view), options);
  remember(clear);
  int partial = 0;
  for (int i = 0; i < 64 * 64; ++i) {
    const uint8_t* p = clear.pixels.data() + 4 * i;
    partial += p[3] > 0 && p[3] < 255;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(p[c], p[3], 1);
  }
  EXPECT_GT(partial, 20);
  options.background = {0.2f, 0.4f, 0.6f, 1};
  const Image solid = still.draw(viewFromCamera(view), options);
  expectColor(solid, 1, 1, {51, 102, 153}, 0.5);
}

// Box on the ground over a transparent background, seen from above a corner.
Image shadowStill(gpu::Device& device, double elevation, float strength, double ground_y_m = 0) {
  Scene scene = testing::boxScene(0.15f, 1.6f);
  scene.character.ground_y_m = ground_y_m;
  scene.setLayers(1, 16);
  for (uint32_t face = 0; face < 12; ++face) scene.setLabel(0, face, 0);
  Still still(device, scene, PictureTextures::Kind::Rgba);
  still.uploadRgba(constantLayers(scene, {{200, 160, 120}}));
  RecipeOptions options;
  options.shadow_strength = strength;
  const PinholeCamera camera = cameraFromOrbit({0, elevation, 4, {0, 0.5, 0}, 35}, 240, 240);
  return still.draw(viewFromCamera(camera), options);
}

TEST_F(Layered, shadowDarkensTheGroundBesideTheFeetOnly) {
  const Image picture = shadowStill(*device, 30, 0.6f);
  remember(picture);
  const PinholeCamera camera = cameraFromOrbit({0, 30, 4, {0, 0.5, 0}, 35}, 240, 240);
  const auto at = [&](const glm::dvec3& point) {
    const glm::dvec3 p = camera.project(point);
    return picture.at(static_cast<int>(p.x), static_cast<int>(p.y));
  };
  const int near_alpha = at({0.20, 0, 0.1})[3], far_alpha = at({0.45, 0, 0.1})[3];
  EXPECT_GT(near_alpha, 30);
  EXPECT_LT(near_alpha, 0.6 * 255);
  EXPECT_GT(near_alpha, far_alpha + 10);
  EXPECT_NEAR(at({0.3, 0, 0})[3], at({-0.3, 0, 0})[3], 6);  // symmetric
  for (const auto& [x, y] : {std::pair(0, 0), {239, 0}, {0, 239}, {239, 239}}) EXPECT_EQ(picture.at(x, y)[3], 0);
  for (int i = 0; i < 240 * 240; ++i) {  // black except on the box
    const uint8_t* p = picture.pixels.data() + 4 * i;
    for (int c = 0; c < 3; ++c) ASSERT_LE(p[c], p[3]);
  }
  EXPECT_EQ(at({0.2, 0, 0.1})[0], 0);
}

TEST_F(Layered, shadowScalesWithItsStrengthAndFadesWithHeight) {
  const PinholeCamera camera = cameraFromOrbit({0, 30, 4, {0, 0.5, 0}, 35}, 240, 240);
  const auto alpha = [&](const Image& picture, const glm::dvec3& point) {
    const glm::dvec3 p = camera.project(point);
    return static_cast<int>(picture.at(static_cast<int>(p.x), static_cast<int>(p.y))[3]);
  };
  const glm::dvec3 beside(0.2, 0, 0.1);
  const int full = alpha(shadowStill(*device, 30, 0.8f), beside);
  EXPECT_NEAR(alpha(shadowStill(*device, 30, 0.4f), beside), full / 2.0, 1.5);
  EXPECT_EQ(alpha(shadowStill(*device, 30, 0.0f), beside), 0);
  const int lifted = alpha(shadowStill(*device, 30, 0.8f, -0.25), {0.2, -0.25, 0.1});
  EXPECT_LT(lifted, full - 15);
  EXPECT_GT(lifted, 0);
}

TEST_F(Layered, noGroundFromBelow) {
  const Image picture = shadowStill(*device, -30, 0.8f);
  remember(picture);
  for (int i = 0; i < 240 * 240; ++i) {
    const uint8_t* p = picture.pixels.data() + 4 * i;
    if (p[0] == 0) {
      ASSERT_EQ(p[3], 0);
    }
  }
}

TEST_F(Layered, debugViewsShowWhatTheyName) {
  Scene scene = testing::quadScene({0, 1}, 1.2f);
  scene.setLayers(2, 16);
  for (uint32_t face = 0; face < 2; ++face) scene.setLabel(0, face, 0), scene.setLabel(1, face, 1);
  Still still(*device, scene, PictureTextures::Kind::Rgba);
  still.uploadRgba(constantLayers(scene, {kColors[0], kColors[1]}));
  const PinholeCamera view = testing::lookAt({0.3, 1.2, 3}, {0, 1, 0}, 64, 64, 80);
  RecipeOptions options = plainOptions();
  options.debug = DebugView::Normals;
  expectColor(still.draw(viewFromCamera(view), options), 30, 30, {127.5, 127.5, 255}, 1.0);
  options.debug = DebugView::Weights;
  const glm::dvec3 point = pointOnPlane(view, 30, 30);
  const double w0 = eq3(scene.character.cameras[0], view, point, plainOptions());
  const double w1 = eq3(scene.character.cameras[1], view, point, plainOptions());
  const glm::dvec3 shares = 255.0 * glm::dvec3(w0, w1, 0) / (w0 + w1);
  expectColor(still.draw(viewFromCamera(view), options), 30, 30, shares, 1.0);
  options.debug = DebugView::Labels;
  const Image first = still.draw(viewFromCamera(view), options);
  options.debug_layer = 1;
  const Image second = still.draw(viewFromCamera(view), options);
  EXPECT_NE(std::memcmp(first.at(30, 30), second.at(30, 30), 3), 0);
}

TEST_F(Layered, drawCallsAndTexturesStayWithinTheProbes) {
  Scene scene = testing::boxScene(0.2f, 1.7f);
  scene.setLayers(3, 64);
  for (uint32_t face = 0; face < 12; ++face)
    for (int rank = 0; rank < 3; ++rank) scene.setLabel(rank, face, static_cast<uint8_t>(rank));
  Still still(*device, scene, PictureTextures::Kind::I420);
  const PinholeCamera view = testing::lookAt({0, 1, 3}, {0, 1, 0}, 64, 64, 80);
  device->resetCounters();
  still.draw(viewFromCamera(view), {});
  EXPECT_EQ(device->counters().draws, 5u);
  still.draw(viewFromCamera(view), {});
  EXPECT_EQ(device->counters().draws, 7u);
  EXPECT_EQ(device->counters().live_textures, 4u + 3 + 2);  // tables, planes, shadow maps
  EXPECT_EQ(device->counters().uploaded_bytes, 0u);
}

}  // namespace
}  // namespace fourdvt::render

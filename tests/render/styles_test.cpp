// SPDX-License-Identifier: Apache-2.0
// Styles of figures: M4D Eq. 8 computed by hand, light from pictures, dots at edges, and the outline of the plain
// picture for figures of both kinds.
#include "render/styles/styles.h"

#include <cmath>

#include "gl_fixture.h"
#include "render/cameras/camera_method.h"

namespace fourdvt::testing {
namespace {

using render::Light;
using render::StyleKind;

constexpr double kRounding = 1.01;  // levels of eight bits

Light evenLight(const glm::vec3& color) {
  Light light{};
  light[0] = color / 0.282095f;
  return light;
}

Image panorama(int height, const std::function<glm::u8vec3(int x, int y)>& color) {
  Image image(2 * height, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < 2 * height; ++x)
      for (int k = 0; k < 3; ++k) image.at(x, y)[k] = color(x, y)[k];
  return image;
}

Light lightOf(const Image& image) {
  auto light = render::lightFromPicture(image.pixels, image.width, image.height, image.channels);
  EXPECT_TRUE(light);
  return light.take();
}

// A tilted box, so that silhouettes fall between pixels; its one layer has a colour per column of texels.
class StylesTest : public GlFixture {
 protected:
  static constexpr int kSide = 64;
  const PinholeCamera view_ = lookAt({0.7, 1.6, 2.8}, {0, 1, 0}, 180, 180, 150);

  void SetUp() override {
    GlFixture::SetUp();
    scene_ = quadScene({0, 1}, 0.9f);
    scene_.setLayers(1, kSide);
    for (uint32_t face = 0; face < 2; ++face) scene_.setLabel(0, face, 0);
    still_ = std::make_unique<Still>(*device, scene_, render::PictureTextures::Kind::Rgba);
    paint([](int, int) { return glm::u8vec3(100, 160, 220); });
  }
  void TearDown() override {
    still_.reset();
    GlFixture::TearDown();
  }

  void paint(const std::function<glm::u8vec3(int x, int y)>& color) {
    Image layer(kSide, kSide, 4, 255);
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        for (int k = 0; k < 3; ++k) layer.at(x, y)[k] = color(x, y)[k];
    still_->uploadRgba(layer);
  }

  Image plain(const PinholeCamera& view) {
    still_->recipe->setStyle(nullptr);
    return drawNow(view);
  }
  Image styled(const render::StyleOptions& style, const PinholeCamera& view) {
    EXPECT_TRUE(render::setStyle(*device, *still_->recipe, style));
    return drawNow(view);
  }
  Image drawNow(const PinholeCamera& view) {
    Image image = still_->draw(render::viewFromCamera(view), {.background = {0, 0, 0, 0}, .ground_shadow = false});
    remember(image);
    return image;
  }

  Scene scene_;
  std::unique_ptr<Still> still_;
};

void expectPixel(const Image& image, int x, int y, const glm::dvec3& color) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(image.at(x, y)[k], color[k], kRounding) << "channel " << k;
}

void expectSameSilhouette(const Image& a, const Image& b) {
  int partial = 0, different = 0;
  for (size_t i = 3; i < a.pixels.size(); i += 4) {
    partial += a.pixels[i] > 0 && a.pixels[i] < 255;
    different += a.pixels[i] != b.pixels[i];
  }
  EXPECT_GT(partial, 20);
  EXPECT_EQ(different, 0);
}

TEST(LightTest, OfAnEvenPictureIsItsColour) {
  const Light light = lightOf(panorama(16, [](int, int) { return glm::u8vec3(51, 128, 204); }));
  for (const glm::vec3& d : {glm::vec3(1, 0, 0), {0, -1, 0}, {0, 0, 1}, {0.6f, -0.48f, 0.64f}}) {
    const glm::vec3 seen = render::lightAt(light, d);
    EXPECT_NEAR(seen.r, 0.2, 2e-3);
    EXPECT_NEAR(seen.g, 128 / 255.0, 2e-3);
    EXPECT_NEAR(seen.b, 0.8, 2e-3);
  }
}

// A hemisphere of light: irradiance of a matte surface is (1 + cos) / 2, exact in three orders at the pole and the rim,
// since even orders above zero vanish.
TEST(LightTest, OfOneHalfComesFromThere) {
  const auto half = [](auto&& lit) {
    return lightOf(panorama(32, [&](int x, int y) { return glm::u8vec3(lit(x, y) ? 255 : 0); }));
  };
  const Light above = half([](int, int y) { return y < 16; }), right = half([](int x, int) { return x >= 32; }),
              ahead = half([](int x, int) { return x >= 16 && x < 48; });
  const auto expectPole = [](const Light& light, const glm::vec3& pole, const glm::vec3& rim) {
    EXPECT_NEAR(render::lightAt(light, pole).g, 1, 0.01);
    EXPECT_NEAR(render::lightAt(light, -pole).g, 0, 0.01);
    EXPECT_NEAR(render::lightAt(light, rim).g, 0.5, 0.01);
  };
  expectPole(above, {0, 1, 0}, {1, 0, 0});
  expectPole(right, {1, 0, 0}, {0, 0, 1});
  expectPole(ahead, {0, 0, -1}, {0, 1, 0});
}

TEST(LightTest, NeedsAPictureTwiceAsWideAsHigh) {
  const std::vector<uint8_t> pixels(64 * 64 * 4);
  EXPECT_TRUE(render::lightFromPicture(pixels, 64, 32, 4));
  EXPECT_TRUE(render::lightFromPicture(pixels, 63, 32, 3));
  EXPECT_EQ(render::lightFromPicture(pixels, 64, 64, 4).error().id, ErrorId::InvalidArgument);
  EXPECT_EQ(render::lightFromPicture(pixels, 64, 32, 1).error().id, ErrorId::InvalidArgument);
  EXPECT_EQ(render::lightFromPicture(std::span(pixels).first(100), 64, 32, 4).error().id, ErrorId::InvalidArgument);
}

TEST_F(StylesTest, HalfLightChangesNothing) {
  paint([](int x, int y) { return glm::u8vec3(4 * x, 4 * y, 255 - 2 * x); });
  const Image before = plain(view_),
              after = styled({.kind = StyleKind::Relit, .light = evenLight(glm::vec3(0.5f))}, view_);
  int largest = 0;
  for (size_t i = 0; i < before.pixels.size(); ++i)
    largest = std::max(largest, std::abs(int(before.pixels[i]) - int(after.pixels[i])));
  EXPECT_LE(largest, 1);
}

TEST_F(StylesTest, FullLightAndDarknessAreEquation8) {
  const auto relit = [&](glm::vec3 light, float strength) {
    return styled({.kind = StyleKind::Relit, .strength = strength, .light = evenLight(light)}, view_);
  };
  const glm::dvec3 c = glm::dvec3(100, 160, 220) / 255.0;
  const auto power = [&](double e) { return 255.0 * glm::pow(c, glm::dvec3(e)); };
  expectPixel(relit(glm::vec3(1), 1), 90, 90, power(0.5));
  expectPixel(relit(glm::vec3(0), 1), 90, 90, power(1.5));
  expectPixel(relit(glm::vec3(7), 1), 90, 90, power(0.5));  // clamped to full light
  expectPixel(relit(glm::vec3(0.8f), 1), 90, 90, 255.0 * c + 0.6 * (power(0.7) - 255.0 * c));
  expectPixel(relit(glm::vec3(0), 0.5f), 90, 90, 0.5 * (power(1.5) + 255.0 * c));
  expectPixel(relit(glm::vec3(0), 0), 90, 90, 255.0 * c);
  const Image coloured = relit({1, 0.5f, 0}, 1);
  expectPixel(coloured, 90, 90, {power(0.5).r, 160, power(1.5).b});
}

// The quad faces the viewer. Light from the right reaches it after a quarter turn clockwise.
TEST_F(StylesTest, LightTurnsClockwiseAndStaysWithTheViewer) {
  const Light right = lightOf(panorama(32, [](int x, int) { return glm::u8vec3(x >= 32 ? 255 : 0); }));
  const PinholeCamera before = lookAt({0, 1, 3}, {0, 1, 0}, 60, 60, 60);
  const auto green = [&](float turn_deg, const PinholeCamera& view) {
    return int(styled({.kind = StyleKind::Relit, .light = right, .light_turn_rad = glm::radians(turn_deg)}, view)
                   .at(30, 30)[1]);
  };
  EXPECT_NEAR(green(0, before), 160, 2);
  EXPECT_NEAR(green(90, before), 255 * std::sqrt(160 / 255.0), 2);
  EXPECT_NEAR(green(-90, before), 255 * std::pow(160 / 255.0, 1.5), 2);
  // Seen from its left, the quad faces to the right of the viewer.
  EXPECT_GT(green(0, lookAt({-2.5, 1, 1.7}, {0, 1, 0}, 60, 60, 60)), 175);
  EXPECT_LT(green(0, lookAt({2.5, 1, 1.7}, {0, 1, 0}, 60, 60, 60)), 145);
}

TEST_F(StylesTest, SketchIsGreyTheSameEveryTimeAndDarkWhereEdgesAre) {
  paint([](int x, int) { return x < kSide / 2 ? glm::u8vec3(60, 90, 40) : glm::u8vec3(230, 240, 220); });
  const PinholeCamera view = lookAt({0, 1, 3}, {0, 1, 0}, 240, 240, 300);
  const Image sketch = styled({.kind = StyleKind::Sketch}, view);
  const Image again = styled({.kind = StyleKind::Sketch}, view);
  EXPECT_EQ(sketch.pixels, again.pixels);
  double beside_edge = 0, far = 0, bright = 0;
  for (int y = 60; y < 180; ++y)
    for (int x = 0; x < 240; ++x) {
      const uint8_t* p = sketch.at(x, y);
      ASSERT_TRUE(p[0] == p[1] && p[1] == p[2]) << x << ' ' << y;
      if (x >= 118 && x < 120) beside_edge += p[0] / 240.0;
      if (x >= 60 && x < 110) far += p[0] / 6000.0;
      if (x >= 130 && x < 180) bright += p[0] / 6000.0;
    }
  EXPECT_LT(far, bright - 20);  // dots are as dark as the picture
  EXPECT_LT(beside_edge, far - 20);
  EXPECT_GT(far, 128);  // paper between them
}

TEST_F(StylesTest, SilhouettesAreThePlainOnes) {
  const Image before = plain(view_);
  for (const StyleKind kind : {StyleKind::Sketch, StyleKind::Relit})
    expectSameSilhouette(before, styled({.kind = kind}, view_));
  for (const StyleKind kind : {StyleKind::Sketch, StyleKind::Relit}) {
    const Image none = styled({.kind = kind, .strength = 0}, view_);
    for (size_t i = 0; i < before.pixels.size(); ++i) ASSERT_NEAR(before.pixels[i], none.pixels[i], 1) << i;
  }
}

TEST_F(StylesTest, RefusesStrengthsOutsideOfZeroToOneAndKeepsTheStyle) {
  const Image before = styled({.kind = StyleKind::Sketch}, view_);
  for (float strength : {-0.1f, 1.1f, std::nanf("")})
    EXPECT_EQ(render::setStyle(*device, *still_->recipe, {.strength = strength}).error().id, ErrorId::InvalidArgument);
  EXPECT_EQ(drawNow(view_).pixels, before.pixels);
}

// Character from cameras: the silhouette method needs no pictures and draws white.
TEST_F(StylesTest, DrawsSurfacesFromCamerasAsWell) {
  package::Character character;
  character.cameras = scene_.character.cameras;
  character.vertex_count = 4;
  character.face_count = 2;
  auto model = render::CharacterModel::createForSurfaces(*device, character).take();
  ASSERT_TRUE(model.setTopology(*device, scene_.mesh.topology.face_vertices, 4));
  model.setPositions(*device, scene_.mesh.positions);
  auto picture = render::createPicture(*device, 8, 8, render::PictureTextures::Kind::Rgba).take();
  const std::vector<render::CameraSource> sources(character.cameras.size());
  const render::CameraLook look{character.cameras, sources, &picture, {8, 8}, 1};
  render::Figure figure;
  figure.model = &model;
  figure.cameras = &look;
  still_->recipe->setMethod(render::makeCameraMethod(*device, "silhouette").take());
  const render::View view = render::viewFromCamera(view_);
  const auto draw = [&] {
    return drawnImage(*device, view, [&](gpu::TargetId target) {
      return still_->recipe->draw({&figure, 1}, nullptr, view, {.recipe = {.ground_shadow = false}}, target);
    });
  };
  const Image before = draw();
  EXPECT_EQ(before.at(90, 90)[0], 255);
  ASSERT_TRUE(render::setStyle(*device, *still_->recipe,
                               {.kind = StyleKind::Relit, .strength = 0.5f, .light = evenLight(glm::vec3(0))}));
  expectSameSilhouette(before, draw());
  EXPECT_EQ(draw().at(90, 90)[0], 255);  // white stays white (M4D Eq. 8)
  ASSERT_TRUE(render::setStyle(*device, *still_->recipe, {.kind = StyleKind::Sketch}));
  expectSameSilhouette(before, draw());
}

}  // namespace
}  // namespace fourdvt::testing

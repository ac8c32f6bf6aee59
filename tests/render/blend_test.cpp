// SPDX-License-Identifier: Apache-2.0
// Members of a look and looks of a figure against analytic blends: weights, baked alignment, four sources, transitions,
// and a synthetic optical flow.
#include "made_up_flow.h"
#include "member_quad.h"

namespace fourdvt::render {
namespace {

using testing::expectColor;
using testing::kTolerance;
using testing::MadeUpFlow;
using testing::MemberQuad;
using testing::plainOptions;

class Blend : public testing::GlFixture {
 protected:
  void SetUp() override {
    GlFixture::SetUp();
    recipe = Recipe::create(*device).take();
  }
  void TearDown() override {
    recipe.reset();
    GlFixture::TearDown();
  }
  Image draw(const Figure& figure, const PinholeCamera& view, const DrawOptions& options) {
    Image image = testing::drawnImage(*device, viewFromCamera(view), [&](gpu::TargetId target) {
      return recipe->draw({&figure, 1}, nullptr, viewFromCamera(view), options, target);
    });
    remember(image);
    return image;
  }
  Image drawLook(const MemberQuad& quad, std::vector<float> weights, Align align) {
    const Look look = quad.look(weights);
    return draw({&quad.model, {&look, 1}}, front, {plainOptions(), align});
  }

  std::unique_ptr<Recipe> recipe;
  // Camera whose picture the quad covers entirely.
  const PinholeCamera front = testing::lookAt({0, 1, 3}, {0, 1, 0}, 120, 120, 200);
};

constexpr uint8_t kOneCamera(int, int) { return 0; }

TEST_F(Blend, membersHaveLabelsAndTilesOfTheirOwn) {
  const uint8_t labels[2][2] = {{0, 1}, {2, 0}};
  MemberQuad quad(*device, 2, 2, [&](int member, int rank) { return labels[member][rank]; });
  const std::vector<glm::dvec3> colors = {{230, 30, 60}, {20, 200, 90}, {70, 40, 250}, {180, 180, 10}};
  quad.paintTiles(*device, colors);
  for (float second : {0.0f, 0.3f, 0.5f, 1.0f}) {
    const Image picture = drawLook(quad, {1 - second, second}, Align::None);
    for (const auto& [x, y] : {std::pair(20, 30), {60, 60}, {100, 90}}) {
      const glm::dvec3 point = testing::pointOnPlane(front, x, y);
      glm::dvec3 expected(0);
      for (int member = 0; member < 2; ++member) {
        glm::dvec3 color(0);
        double sum = 0;
        for (int rank = 0; rank < 2; ++rank) {
          const double weight =
              testing::eq3(quad.scene.character.cameras[labels[member][rank]], front, point, plainOptions());
          color += weight * colors[2 * member + rank];
          sum += weight;
        }
        expected += double(member ? second : 1 - second) * color / sum;
      }
      expectColor(picture, x, y, expected, kTolerance);
    }
  }
}

// Content d metres apart meets at the weighted mean: uv - w1 δ in one member, uv + w0 δ in the other.
TEST_F(Blend, bakedAlignmentBringsBothMembersHalfWay) {
  MemberQuad quad(*device, 2, 1, kOneCamera);
  quad.paint(*device, [](int tile, double u, double v) {
    return tile == 0 ? glm::dvec3(255 * u, 255 * v, 0) : glm::dvec3(0, 255 * v, 255 * u);
  });
  const glm::vec2 d(0.16f, 0.1f);  // right and up, which is -v
  const glm::dvec2 delta(0.08, -0.05);
  quad.align(*device, {d});
  for (double w1 : {0.2, 0.5, 0.9}) {
    const Image picture = drawLook(quad, {float(1 - w1), float(w1)}, Align::Baked);
    for (const auto& [x, y] : {std::pair(20, 30), {60, 60}, {95, 85}}) {
      const glm::dvec2 uv = testing::uvAt(front, x, y);
      const glm::dvec2 first = 255.0 * (uv - w1 * delta), second = 255.0 * (uv + (1 - w1) * delta);
      expectColor(picture, x, y, {(1 - w1) * first.x, (1 - w1) * first.y + w1 * second.y, w1 * second.x}, kTolerance);
    }
  }
  const Image plain = drawLook(quad, {0.5f, 0.5f}, Align::None);
  const glm::dvec2 uv = testing::uvAt(front, 60, 60);
  expectColor(plain, 60, 60, {127.5 * uv.x, 255 * uv.y, 127.5 * uv.x}, kTolerance);
  quad.align(*device, {});
  expectColor(drawLook(quad, {0.5f, 0.5f}, Align::Baked), 60, 60, {127.5 * uv.x, 255 * uv.y, 127.5 * uv.x}, kTolerance);
}

TEST_F(Blend, aMemberAloneIsNotMoved) {
  MemberQuad quad(*device, 2, 1, kOneCamera);
  quad.paint(*device, [](int tile, double u, double v) { return glm::dvec3(255 * u, 255 * v, 100 * tile); });
  quad.align(*device, {{0.2f, 0.2f}});
  for (int member : {0, 1}) {
    const Image picture = drawLook(quad, {float(1 - member), float(member)}, Align::Baked);
    const glm::dvec2 uv = testing::uvAt(front, 40, 80);
    expectColor(picture, 40, 80, {255 * uv.x, 255 * uv.y, 100.0 * member}, kTolerance);
  }
}

// Stripes present in one member only: their mean has half the contrast, which is amplified by sqrt 2. Relative to both
// neighbours a quarter of a period away, the whole stripe is detail.
TEST_F(Blend, detailThatDoesNotCorrelateKeepsItsContrast) {
  constexpr double kPeriod_texels = 12;
  MemberQuad quad(*device, 2, 1, kOneCamera);
  const auto stripe = [&](double u) { return 80 * std::sin(2 * M_PI * u * MemberQuad::kSide / kPeriod_texels); };
  quad.paint(*device, [&](int tile, double u, double) { return glm::dvec3(128 + (tile == 0 ? stripe(u) : 0)); });
  quad.align(*device, {{0, 0}});
  quad.appearance.detail_correlation = 0;
  const Image kept = drawLook(quad, {0.5f, 0.5f}, Align::Baked), plain = drawLook(quad, {0.5f, 0.5f}, Align::None);
  quad.appearance.detail_correlation = 1;
  const Image alike = drawLook(quad, {0.5f, 0.5f}, Align::Baked);
  quad.appearance.detail_correlation = 0;
  const Image alone = drawLook(quad, {1, 0}, Align::Baked);
  for (int x = 20; x < 100; x += 3) {
    const double s = stripe(testing::uvAt(front, x, 60).x);
    expectColor(kept, x, 60, glm::dvec3(128 + std::sqrt(0.5) * s), 3);
    for (const Image* picture : {&plain, &alike}) expectColor(*picture, x, 60, glm::dvec3(128 + 0.5 * s), 3);
    expectColor(alone, x, 60, glm::dvec3(128 + s), 5);
  }
}

TEST_F(Blend, fourMembersOfThreeLayersInOneDraw) {
  MemberQuad quad(*device, 4, 3, [](int member, int rank) { return uint8_t((member + rank) % 3); });
  std::vector<glm::dvec3> colors;
  for (int member = 0; member < 4; ++member)
    colors.insert(colors.end(), 3, {60.0 * member, 255 - 60.0 * member, member == 2 ? 200 : 20});
  quad.paintTiles(*device, colors);
  quad.align(*device, {{0.01f, 0}, {0, 0.01f}, {0.02f, 0.01f}});
  const std::vector<float> weights = {0.1f, 0.4f, 0.3f, 0.2f};
  device->resetCounters();
  const Image picture = drawLook(quad, weights, Align::Baked);
  EXPECT_EQ(device->counters().draws, 1u);
  glm::dvec3 expected(0);
  for (int member = 0; member < 4; ++member) expected += double(weights[member]) * colors[3 * member];
  expectColor(picture, 60, 60, expected, kTolerance);
}

TEST_F(Blend, maxLayersAndMembersFitTheVaryings) {
  MemberQuad quad(*device, 4, 6, [](int member, int rank) { return uint8_t((member + rank) % 3); });
  quad.paintTiles(*device, std::vector<glm::dvec3>(24, {50, 100, 150}));
  quad.align(*device, {{0.01f, 0}, {0, 0.01f}, {0.02f, 0.01f}});
  expectColor(drawLook(quad, {0.25f, 0.25f, 0.25f, 0.25f}, Align::Baked), 60, 60, {50, 100, 150}, kTolerance);
}

struct Transition : Blend {
  // Draws a tilted quad without anything behind it, multisampled.
  Image drawFade(const MemberQuad& first, const MemberQuad& second, float fade, Align align = Align::None) {
    const Look looks[] = {first.look(kWhole), second.look(kWhole)};
    DrawOptions options{plainOptions(), align};
    options.recipe.samples = 4;
    return draw({&first.model, looks, fade}, tilted, options);
  }
  static constexpr float kWhole[] = {1};
  const PinholeCamera tilted = testing::lookAt({0.7, 1.4, 3}, {0, 1, 0}, 96, 96, 90);
};

TEST_F(Transition, twoLooksFade) {
  MemberQuad first(*device, 1, 1, kOneCamera), second(*device, 1, 1, [](int, int) { return uint8_t(1); });
  first.paintTiles(*device, {{240, 40, 80}});
  second.paintTiles(*device, {{40, 200, 0}});
  for (double fade : {0.0, 0.25, 0.5, 1.0}) {
    const Image picture = drawFade(first, second, float(fade));
    expectColor(picture, 48, 48, glm::mix(glm::dvec3(240, 40, 80), glm::dvec3(40, 200, 0), fade), kTolerance);
  }
}

TEST_F(Transition, itsEdgesAreThoseOfAPlainDraw) {
  MemberQuad first(*device, 1, 1, kOneCamera), second(*device, 1, 1, kOneCamera);
  for (MemberQuad* quad : {&first, &second}) quad->paintTiles(*device, {{255, 255, 255}});
  const Image direct = drawFade(first, second, 0), mixed = drawFade(first, second, 0.5f);
  int partial = 0;
  for (size_t i = 0; i < direct.pixels.size(); i += 4) {
    const uint8_t *a = &direct.pixels[i], *b = &mixed.pixels[i];
    partial += a[3] > 0 && a[3] < 255;
    ASSERT_EQ(a[3], b[3]) << "coverage differs";
    ASSERT_NEAR(b[0], b[3], 2) << "dark or bright fringe";
  }
  EXPECT_GT(partial, 40);
}

struct Flow : Transition {
  int calls = 0;
  void setFlow(const glm::vec2& flow) { recipe->setFlow(std::make_unique<MadeUpFlow>(*device, flow, calls)); }
};

// 4DVT Eq. 7 corrected: w0 I0(p - w1 f) + w1 I1(p + w0 f).
TEST_F(Flow, warpsAndBlendsMembersAsEquation7) {
  MemberQuad quad(*device, 2, 1, kOneCamera);
  quad.paint(*device, [](int tile, double u, double v) {
    return tile == 0 ? glm::dvec3(255 * u, 255 * v, 0) : glm::dvec3(0, 255 * v, 255 * u);
  });
  const glm::dvec2 flow(6, 4);  // GL rows: up
  setFlow(flow);
  for (double w1 : {0.25, 0.5}) {
    const Image picture = drawLook(quad, {float(1 - w1), float(w1)}, Align::Flow);
    for (const auto& [x, y] : {std::pair(30, 40), {60, 60}, {85, 75}}) {
      const glm::dvec2 uv = testing::uvAt(front, x, y);
      const glm::dvec2 a_pixel = testing::uvAt(front, 61, 61) - testing::uvAt(front, 60, 60);
      const glm::dvec2 delta = a_pixel * glm::dvec2(flow.x, -flow.y);
      const glm::dvec2 first = 255.0 * (uv - w1 * delta), second = 255.0 * (uv + (1 - w1) * delta);
      expectColor(picture, x, y, {(1 - w1) * first.x, (1 - w1) * first.y + w1 * second.y, w1 * second.x}, kTolerance);
    }
  }
  EXPECT_EQ(calls, 2);
  drawLook(quad, {1, 0}, Align::Flow);
  EXPECT_EQ(calls, 2) << "one member needs no flow";
}

TEST_F(Flow, withoutMotionItIsThePlainBlendOfAnyNumber) {
  MemberQuad quad(*device, 3, 1, kOneCamera);
  quad.paint(*device, [](int tile, double u, double v) { return glm::dvec3(90.0 * tile, 255 * u, 255 * v); });
  setFlow({0, 0});
  const std::vector<float> weights = {0.2f, 0.5f, 0.3f};
  const Image flow = drawLook(quad, weights, Align::Flow), plain = drawLook(quad, weights, Align::None);
  EXPECT_EQ(calls, 2);
  for (size_t i = 0; i < flow.pixels.size(); ++i) ASSERT_NEAR(flow.pixels[i], plain.pixels[i], 2);
}

TEST_F(Flow, fallsBackToThePlainBlendWhereItLeavesTheCharacter) {
  MemberQuad first(*device, 1, 1, kOneCamera), second(*device, 1, 1, kOneCamera);
  first.paintTiles(*device, {{240, 40, 80}});
  second.paintTiles(*device, {{40, 200, 0}});
  setFlow({500, 0});
  const Image flow = drawFade(first, second, 0.5f, Align::Flow), plain = drawFade(first, second, 0.5f);
  EXPECT_EQ(calls, 1);
  for (size_t i = 0; i < flow.pixels.size(); ++i) ASSERT_NEAR(flow.pixels[i], plain.pixels[i], 3);
}

}  // namespace
}  // namespace fourdvt::render

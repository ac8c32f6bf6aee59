// SPDX-License-Identifier: Apache-2.0
// Montage4D over layers: a camera fades out over the clamp distance towards the end of its label set, the plain blend
// where all fields are zero, fields that follow the view, and the assignment of fields to several looks and members.
#include "render/montage/layered_montage.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "../unit/scaled.h"
#include "expected.h"
#include "gl_fixture.h"
#include "made_up_flow.h"
#include "member_quad.h"

namespace fourdvt::testing {
namespace {

constexpr int kCells = 80;        // along each side
constexpr float kSide_m = 0.8f;   // of the square in the plane z = 0
constexpr double kClamp_m = 0.1;  // as in layered_montage.cpp

// Square whose faces left of x = 0 have the cameras `left`, others `right`, by rank; kNoCamera: none.
Scene squareScene(std::array<uint8_t, 2> left, std::array<uint8_t, 2> right) {
  Scene scene = quadScene({0, 1}, kSide_m / 2);
  MeshTopology& topology = scene.mesh.topology;
  scene.mesh.positions.clear();
  topology = {};
  for (int y = 0; y <= kCells; ++y)
    for (int x = 0; x <= kCells; ++x) {
      const glm::vec2 at(float(x) / kCells, float(y) / kCells);
      scene.mesh.positions.emplace_back(kSide_m * (at.x - 0.5f), 1 + kSide_m * (0.5f - at.y), 0);
      topology.uvs.push_back(at);
    }
  for (uint32_t y = 0; y < kCells; ++y)
    for (uint32_t x = 0; x < kCells; ++x) {
      const uint32_t a = y * (kCells + 1) + x, b = a + kCells + 1;
      topology.face_vertices.push_back({a, b, b + 1});
      topology.face_vertices.push_back({a, b + 1, a + 1});
    }
  topology.face_uvs = topology.face_vertices;
  scene.finish();
  scene.setLayers(2, 16);
  for (uint32_t face = 0; face < topology.faceCount(); ++face)
    for (int rank = 0; rank < 2; ++rank)
      scene.setLabel(rank, face, (face / 2 % kCells < kCells / 2 ? left : right)[size_t(rank)]);
  return scene;
}

class LayeredMontageTest : public GlFixture {
 protected:
  const PinholeCamera view_ = lookAt({0.2, 1, 2.5}, {0, 1, 0}, 320, 40, 900);
  float exponent_ = 1;  // both powers of the plain blend; by 1 camera 1 is seen right up to the seam

  void show(const Scene& scene) {
    scene_ = scene;
    still_ = std::make_unique<Still>(*device, scene_, render::PictureTextures::Kind::Rgba);
    still_->uploadRgba(constantLayers(scene_, {{250, 250, 250}, {10, 10, 10}}));
  }
  void useMontage() {
    auto montage = render::makeLayeredMontage(*device);
    ASSERT_TRUE(montage) << montage.error().message;
    still_->recipe->setLayered(montage.take());
  }
  void TearDown() override {
    still_.reset();
    GlFixture::TearDown();
  }
  Image draw(const PinholeCamera& view, float elapsed_s = std::numeric_limits<float>::infinity()) {
    const float whole[] = {1};
    const render::Look look{&still_->figure.appearance, &still_->picture, whole};
    const render::Figure figure{&still_->figure.model, {&look, 1}};
    const render::View seen = render::viewFromCamera(view, render::lengthScalesOf({&figure, 1}));
    render::DrawOptions options{.recipe = plainOptions()};
    options.recipe.facing_exponent = options.recipe.view_exponent = exponent_;
    options.method.elapsed_s = elapsed_s;
    const Image image = drawnImage(*device, seen, [&](gpu::TargetId target) {
      return still_->recipe->draw({&figure, 1}, nullptr, seen, options, target);
    });
    remember(image);
    return image;
  }

  Scene scene_;
  std::unique_ptr<Still> still_;
};

// Weight of the dark camera 1 at this pixel.
double darkness(const Image& image, int x) { return (250 - image.at(x, 20)[0]) / 240.0; }

// Aims of montage_aims.frag at γ = 1: (n·v_i)² (v·v_i)⁴; the square faces +z.
double viewing(const PinholeCamera& camera, const PinholeCamera& view, const glm::dvec3& point) {
  const glm::dvec3 ray = glm::normalize(camera.centreInWorld() - point);
  return std::pow(ray.z, 2) * std::pow(glm::dot(ray, glm::normalize(view.centreInWorld() - point)), 4);
}

TEST_F(LayeredMontageTest, ASeamBetweenTwoLabelSetsFadesOverTheClampDistance) {
  show(squareScene({0, 1}, {0, package::kNoCamera}));
  const Image plain = draw(view_);
  useMontage();
  const Image picture = draw(view_);
  double widest = 0, plain_widest = 0;
  for (int x = 40; x < 300; x += 4) {
    const glm::dvec3 point = pointOnPlane(view_, x, 20);
    // The seam's triangles are one cell wide and end there.
    const double distance = -point.x - kSide_m / kCells;
    const double gamma = std::clamp(distance / kClamp_m, 0.0, 1.0);
    const double w0 = viewing(scene_.character.cameras[0], view_, point),
                 w1 = gamma * viewing(scene_.character.cameras[1], view_, point);
    EXPECT_NEAR(darkness(picture, x), w1 / (w0 + w1), 0.04) << "at " << point.x;
    if (darkness(picture, x) > 0.02 && gamma < 1) widest = std::max(widest, distance);
    if (darkness(plain, x) < 0.3) plain_widest = std::max(plain_widest, -point.x);
  }
  EXPECT_GT(widest, 0.6 * kClamp_m);
  EXPECT_LT(plain_widest, 2 * kSide_m / kCells);
}

TEST_F(LayeredMontageTest, ASeamFadesOverTheSamePartOfAFigureOfAnySize) {
  const auto picture = [&](double scale) {
    Scene scene = squareScene({0, 1}, {0, package::kNoCamera});
    scene.mesh.positions = scaled(scene.mesh.positions, scale);
    for (PinholeCamera& camera : scene.character.cameras) camera = scaled(camera, scale);
    scene.character.length_scale = scale;
    scene.finish();
    show(scene);
    useMontage();
    return draw(scaled(view_, scale));
  };
  const Image person = picture(1);
  for (const double scale : {0.05, 20.0}) EXPECT_LT(shareThatDiffers(person, picture(scale), 3), 0.01) << scale;
}

TEST_F(LayeredMontageTest, TheSameSetEverywhereHasNoSeam) {
  show(squareScene({0, 1}, {0, 1}));
  useMontage();
  const Image picture = draw(view_);
  for (int x = 20; x < 300; x += 20) {
    const glm::dvec3 point = pointOnPlane(view_, x, 20);
    const double w0 = viewing(scene_.character.cameras[0], view_, point),
                 w1 = viewing(scene_.character.cameras[1], view_, point);
    EXPECT_NEAR(darkness(picture, x), w1 / (w0 + w1), 0.015);
  }
}

// One camera on each side: at the seam all fields are zero.
TEST_F(LayeredMontageTest, ThePlainBlendTakesOverWhereNoFieldIsLeft) {
  exponent_ = 2;
  show(squareScene({0, package::kNoCamera}, {package::kNoCamera, 1}));
  const Image plain = draw(view_);
  useMontage();
  const Image picture = draw(view_);
  for (int x = 0; x < 320; ++x) EXPECT_NEAR(picture.at(x, 20)[0], plain.at(x, 20)[0], 1) << x;
}

TEST_F(LayeredMontageTest, FieldsFollowAnAbruptTurnWithTime) {
  show(squareScene({0, 1}, {0, 1}));
  useMontage();
  const PinholeCamera left = lookAt({-1.8, 1, 1.7}, {0, 1, 0}, 320, 40, 900),
                      right = lookAt({1.8, 1, 1.7}, {0, 1, 0}, 320, 40, 900);
  const double goal = darkness(draw(right), 160), start = darkness(draw(left), 160);
  ASSERT_GT(goal, start + 0.2);
  EXPECT_NEAR(darkness(draw(right, 0), 160), start, 0.01);
  const double later = darkness(draw(right, 0.1f), 160);
  EXPECT_GT(later, start + 0.05);
  EXPECT_LT(later, goal - 0.05);
  EXPECT_NEAR(darkness(draw(right, 3), 160), goal, 0.01);
}

constexpr uint8_t kLabels[2][2] = {{0, 1}, {1, 2}};  // [member][rank]

class MontageOfMany : public GlFixture {
 protected:
  void SetUp() override {
    GlFixture::SetUp();
    renew();
  }
  void TearDown() override {
    recipe_.reset();
    quads_.clear();
    GlFixture::TearDown();
  }
  // Creates a new recipe, without fields.
  void renew() {
    recipe_ = render::Recipe::create(*device).take();
    recipe_->setFlow(std::make_unique<MadeUpFlow>(*device, glm::vec2(0), flow_calls_));
    recipe_->setLayered(render::makeLayeredMontage(*device).take());
  }
  // first: member of kLabels that the quad's first one copies.
  MemberQuad& addQuad(int members, int first = 0) {
    quads_.push_back(std::make_unique<MemberQuad>(*device, members, 2,
                                                  [&](int member, int rank) { return kLabels[first + member][rank]; }));
    quads_.back()->paintTiles(
        *device, std::vector<glm::dvec3>(kTiles.begin() + 2 * first, kTiles.begin() + 2 * (first + members)));
    return *quads_.back();
  }
  Image draw(std::span<const render::Figure> figures, const PinholeCamera& view, float elapsed_s,
             render::Align align = render::Align::None) {
    const render::View seen = render::viewFromCamera(view);
    render::DrawOptions options{.recipe = plainOptions(), .align = align};
    options.method.elapsed_s = elapsed_s;
    const Image image = drawnImage(
        *device, seen, [&](gpu::TargetId target) { return recipe_->draw(figures, nullptr, seen, options, target); });
    remember(image);
    return image;
  }
  Image drawLook(const MemberQuad& quad, std::vector<float> weights, const PinholeCamera& view, float elapsed_s,
                 render::Align align = render::Align::None) {
    const render::Look look = quad.look(weights);
    const render::Figure figure{&quad.model, {&look, 1}};
    return draw({&figure, 1}, view, elapsed_s, align);
  }
  // Draws this many quads of one look in a row, correspondingly smaller.
  Image drawRow(size_t first, size_t count) {
    const float whole[] = {1};
    std::vector<render::Look> looks;
    std::vector<render::Figure> figures;
    for (size_t i = first; i < first + count; ++i) looks.push_back(quads_[i]->look(whole));
    for (size_t i = 0; i < count; ++i) {
      figures.push_back({&quads_[first + i]->model, {&looks[i], 1}});
      figures.back().world_from_character = placeInRow(first + i);
    }
    return draw(figures, kRow, kStill);
  }
  static glm::mat4 placeInRow(size_t i) {
    return glm::scale(glm::translate(glm::mat4(1), glm::vec3(0.1f * (float(i) - 8), 0, 0)), glm::vec3(0.04f));
  }
  static glm::ivec2 pixelInRow(size_t i) {
    const glm::dvec3 at = kRow.cam_from_world * glm::dvec4(placeInRow(i) * glm::vec4(0, 1, 0, 1));
    return glm::ivec2(kRow.fx * at.x / at.z + kRow.cx, kRow.fy * at.y / at.z + kRow.cy);
  }

  static constexpr float kStill = std::numeric_limits<float>::infinity();
  static inline const std::vector<glm::dvec3> kTiles = {{250, 250, 0}, {10, 10, 0}, {0, 250, 250}, {0, 10, 10}};
  static inline const PinholeCamera kRow = lookAt({0.2, 0.04, 2.5}, {0, 0.04, 0}, 340, 40, 450),
                                    kLeft = lookAt({-1.8, 1, 1.7}, {0, 1, 0}, 40, 40, 100),
                                    kRight = lookAt({1.8, 1, 1.7}, {0, 1, 0}, 40, 40, 100);
  int flow_calls_ = 0;
  std::vector<std::unique_ptr<MemberQuad>> quads_;
  std::unique_ptr<render::Recipe> recipe_;
};

TEST_F(MontageOfMany, MoreLooksThanFieldsAreKeptForAreDrawnInOnePicture) {
  for (int i = 0; i < 17; ++i) addQuad(1, i % 2);
  const Image together = drawRow(0, 17);
  for (size_t i : {0, 7, 16}) {
    renew();
    const Image alone = drawRow(i, 1);
    const glm::ivec2 at = pixelInRow(i);
    ASSERT_EQ(alone.at(at.x, at.y)[3], 255);
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(together.at(at.x, at.y)[c], alone.at(at.x, at.y)[c], 1) << i;
  }
}

TEST_F(MontageOfMany, FieldsAreForgottenAfterLongDisuseOnly) {
  const MemberQuad& quad = addQuad(1);
  for (int i = 0; i < 17; ++i) addQuad(1);
  const auto brightness = [&](const PinholeCamera& view, float elapsed_s) {
    return double(drawLook(quad, {1}, view, elapsed_s).at(20, 20)[0]);
  };
  const double goal = brightness(kRight, kStill), start = brightness(kLeft, kStill);
  ASSERT_GT(start, goal + 40);
  drawRow(1, 17);
  EXPECT_NEAR(brightness(kRight, 0), start, 3);
  for (int i = 0; i < 16; ++i) drawRow(1, 17);
  EXPECT_NEAR(brightness(kRight, 0), goal, 3) << "as at the first time";
}

TEST_F(MontageOfMany, MembersMixedByFlowHaveFieldsOfTheirOwn) {
  const MemberQuad& quad = addQuad(2);
  const auto turn = [&](std::vector<float> weights) {
    renew();
    drawLook(quad, weights, kLeft, kStill, render::Align::Flow);
    return drawLook(quad, weights, kRight, 0.1f, render::Align::Flow);
  };
  const Image first = turn({1, 0}), second = turn({0, 1}), mixed = turn({0.5f, 0.5f});
  EXPECT_GT(flow_calls_, 0);
  for (const glm::ivec2 at : {glm::ivec2(20, 20), glm::ivec2(10, 28)})
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(mixed.at(at.x, at.y)[c], 0.5 * (first.at(at.x, at.y)[c] + second.at(at.x, at.y)[c]), 2) << c;
}

// The target is the second look while it fades in, and the only one afterwards.
TEST_F(MontageOfMany, NothingPopsWhereATransitionEnds) {
  const MemberQuad &source = addQuad(1, 0), &target = addQuad(1, 1);
  const float whole[] = {1};
  std::array<render::Look, 2> looks = {source.look(whole), target.look(whole)};
  render::Figure figure{&source.model, looks, 0.5f};
  draw({&figure, 1}, kLeft, kStill);
  figure.fade = 1;
  const Image last = draw({&figure, 1}, kRight, 0.05f);
  looks[0] = looks[1];
  figure = {&source.model, {looks.data(), 1}};
  const Image after = draw({&figure, 1}, kRight, 0);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x)
      for (int c = 0; c < 4; ++c) ASSERT_NEAR(after.at(x, y)[c], last.at(x, y)[c], 1) << x << "," << y;
}

TEST(LayeredMontageDevices, WithoutHalfFloatTargetsIsRefused) {
  const auto device = gpu::createNullDevice(false);
  EXPECT_EQ(render::makeLayeredMontage(*device).error().id, ErrorId::Unsupported);
  EXPECT_TRUE(render::makeLayeredMontage(*gpu::createNullDevice(true)));
}

}  // namespace
}  // namespace fourdvt::testing

// SPDX-License-Identifier: Apache-2.0
// Montage4D over layers: a camera fades out over the clamp distance to where its label set ends, the plain blend where
// no field is left, and fields that follow the view.
#include "render/montage/layered_montage.h"

#include <cmath>

#include "expected.h"
#include "gl_fixture.h"

namespace fourdvt::testing {
namespace {

constexpr int kCells = 80;        // along each side
constexpr float kSide_m = 0.8f;   // of the square in the plane z = 0
constexpr double kClamp_m = 0.1;  // of layered_montage.cpp

// Left of x = 0 faces have the cameras `left`, right of it `right`; rank by rank, kNoCamera: none.
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
    const render::View seen = render::viewFromCamera(view);
    render::DrawOptions options{.recipe = plainOptions()};
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

// Share of the dark camera 1 at this pixel.
double darkness(const Image& image, int x) { return (250 - image.at(x, 20)[0]) / 240.0; }

// γ = 1 in the aims of montage_aims.frag: (n·v_i)² (v·v_i)⁴; the square faces +z.
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

// One camera on each side: at the seam no field is left.
TEST_F(LayeredMontageTest, ThePlainBlendTakesOverWhereNoFieldIsLeft) {
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

TEST(LayeredMontageDevices, WithoutHalfFloatTargetsIsRefused) {
  const auto device = gpu::createNullDevice(false);
  EXPECT_EQ(render::makeLayeredMontage(*device).error().id, ErrorId::Unsupported);
  EXPECT_TRUE(render::makeLayeredMontage(*gpu::createNullDevice(true)));
}

}  // namespace
}  // namespace fourdvt::testing

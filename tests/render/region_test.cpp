// SPDX-License-Identifier: Apache-2.0
// Multisampling in the figures' region gives the same picture as multisampling of the whole view, with less memory.
#include "gl_fixture.h"
#include "mannequin.h"
#include "render/cameras/camera_method.h"
#include "render/styles/styles.h"

namespace fourdvt::render {
namespace {

using testing::lookAt;
using testing::Mannequin;

constexpr float kWhole[] = {1};

class RegionTest : public testing::GlFixture {
 protected:
  void SetUp() override {
    GlFixture::SetUp();
    still_ = std::make_unique<testing::Still>(*device, mannequin_.scene, PictureTextures::Kind::Rgba);
    still_->uploadRgba(mannequin_.picture());
    look_ = {&still_->figure.appearance, &still_->picture, kWhole};
    whole_recipe_ = Recipe::create(*device).take();
    // Invisible mesh that forces multisampling of the whole view.
    const std::vector<SceneCorner> far_below(3, SceneCorner{{0, -1000, 0}});
    everywhere_.meshes.push_back(makeSceneMesh(*device, far_below, true).take());
    everywhere_.ground_y_m = float(mannequin_.scene.character.ground_y_m);
  }
  void TearDown() override {
    still_.reset();
    whole_recipe_.reset();
    everywhere_ = {};
    GlFixture::TearDown();
  }

  Figure figure(const glm::vec3& at = {}) const {
    Figure out{&still_->figure.model, {&look_, 1}};
    out.world_from_character[3] = glm::vec4(at, 1);
    return out;
  }

  Image draw(Recipe& recipe, const Scene* scene, std::span<const Figure> figures, const PinholeCamera& camera) {
    const View view = viewFromCamera(camera);
    Image out = testing::drawnImage(
        *device, view, [&](gpu::TargetId target) { return recipe.draw(figures, scene, view, options_, target); });
    remember(out);
    return out;
  }

  // Expects equal pictures, except for rounding: blending of the finished figures may round levels differently. The
  // viewport's offset may move a corner to the next step of the rasteriser's grid, so that a sample at an edge changes
  // sides.
  void expectSamePictures(std::span<const Figure> figures, const PinholeCamera& camera) {
    const Image part = draw(*still_->recipe, nullptr, figures, camera),
                whole = draw(*whole_recipe_, &everywhere_, figures, camera);
    int at_edges = 0;  // pixels
    for (size_t i = 0; i < part.pixels.size(); i += 4) {
      int most = 0;
      for (size_t k = i; k < i + 4; ++k) most = std::max(most, std::abs(part.pixels[k] - whole.pixels[k]));
      at_edges += most > 1;
      ASSERT_LE(most, 255 / 4 + 1) << i / 4 % size_t(part.width) << ", " << i / 4 / size_t(part.width);
    }
    EXPECT_LE(at_edges, 4);
  }
  // Bytes of the multisampled target.
  uint64_t targetBytes(Recipe& recipe, const PinholeCamera& camera) {
    const uint64_t before = device->counters().live_target_bytes;
    const Figure one = figure();
    draw(recipe, nullptr, {&one, 1}, camera);
    return device->counters().live_target_bytes - before;
  }

  Mannequin mannequin_{3000};
  std::unique_ptr<testing::Still> still_;
  std::unique_ptr<Recipe> whole_recipe_;
  Scene everywhere_;
  Look look_;
  DrawOptions options_;
};

TEST_F(RegionTest, aFigureWithItsShadowLooksTheSame) {
  const Figure one = figure();
  for (const double azimuth : {0.0, 33.0, 71.0, 140.0, 250.0})
    for (const double elevation : {-10.0, 5.0, 40.0})
      expectSamePictures({&one, 1}, cameraFromOrbit({azimuth, elevation, 5, {0.1, 0.9, 0}, 35}, 390, 844));
}

TEST_F(RegionTest, aFigureTakesSamplesOnlyWhereItIs) {
  constexpr uint64_t kShadowMap = 128 * 128 * 4, kWholeView = 390 * 844 * 4 * 8;
  const auto bytes = [&](double distance_m) {
    const auto recipe = Recipe::create(*device).take();
    return targetBytes(*recipe, cameraFromOrbit({0, 5, distance_m, {0, 0.9, 0}, 35}, 390, 844)) - kShadowMap;
  };
  EXPECT_LT(bytes(4.5), kWholeView / 2);
  EXPECT_LT(bytes(9), kWholeView / 5);
  EXPECT_EQ(bytes(0.4), kWholeView);
}

TEST_F(RegionTest, backgroundsLookTheSame) {
  const Figure one = figure({0.4f, 0, 0});
  options_.recipe.background = {0.1f, 0.37f, 0.2f, 0.5f};
  for (const int samples : {0, 4}) {
    options_.recipe.samples = samples;
    expectSamePictures({&one, 1}, cameraFromOrbit({20, 10, 6, {0, 0.9, 0}, 35}, 333, 501));
    options_.recipe.ground_shadow = !options_.recipe.ground_shadow;
  }
}

TEST_F(RegionTest, figuresThatLeaveTheViewLookTheSame) {
  const Figure one = figure();
  for (const glm::dvec3& target : {glm::dvec3(0, 1.6, 0), {0.8, 0.3, 0}, {-1.2, 0.9, 0}, {0, 3, 0}, {4, 0.9, 0}})
    for (const double distance_m : {0.25, 1.0, 4.0}) {
      still_->recipe = Recipe::create(*device).take();  // starts with the region of this view
      expectSamePictures({&one, 1}, cameraFromOrbit({15, 5, distance_m, target, 50}, 300, 400));
    }
}

TEST_F(RegionTest, aViewFromWithinTheBoundsLooksTheSame) {
  const Figure one = figure();
  expectSamePictures({&one, 1}, lookAt({0.2, 0.5, 0.12}, {0.05, 0, 0}, 300, 200, 150));
  expectSamePictures({&one, 1}, lookAt({0.5, 1.5, 0.05}, {3, 1, 0}, 300, 200, 150));  // away from it
}

TEST_F(RegionTest, twoFiguresLookTheSame) {
  const Figure two[] = {figure({-0.9f, 0, 0.4f}), figure({0.5f, 0, -0.6f})};
  expectSamePictures(two, cameraFromOrbit({0, 10, 7, {0, 0.9, 0}, 35}, 480, 320));
  expectSamePictures(two, cameraFromOrbit({80, 60, 9, {1, 0.9, 0}, 35}, 480, 320));
}

TEST_F(RegionTest, transitionsLookTheSame) {
  const Look looks[] = {look_, look_};
  Figure fading = figure();
  fading.looks = looks;
  fading.fade = 0.3f;
  expectSamePictures({&fading, 1}, cameraFromOrbit({20, 10, 6, {0.7, 0.9, 0}, 35}, 360, 500));
}

TEST_F(RegionTest, sketchesLookTheSame) {
  const Figure one = figure();
  for (Recipe* recipe : {still_->recipe.get(), whole_recipe_.get()})
    ASSERT_TRUE(setStyle(*device, *recipe, {.kind = StyleKind::Sketch}));
  expectSamePictures({&one, 1}, cameraFromOrbit({20, 10, 6, {0.7, 1.1, 0}, 35}, 361, 503));
}

// Methods that sample pictures of the whole view at a fragment's pixel.
TEST_F(RegionTest, figuresFromCamerasLookTheSame) {
  const testing::Scene& scene = mannequin_.scene;
  auto model = CharacterModel::createForSurfaces(*device, scene.character).take();
  ASSERT_TRUE(model.setTopology(*device, scene.mesh.topology.face_vertices, scene.character.vertex_count));
  model.setPositions(*device, scene.mesh.positions);
  std::vector<CameraSource> sources;
  for (size_t c = 0; c < scene.character.cameras.size(); ++c)
    sources.push_back({{0, 0, 720, 960}, {0.125f * float(c), 0, 0.125f, 1}});
  const CameraLook look{scene.character.cameras, sources, &still_->picture, {192, 64}, 1};
  Figure one{&model};
  one.cameras = &look;
  for (const char* method : {"sweep", "linear"}) {
    for (Recipe* recipe : {still_->recipe.get(), whole_recipe_.get()})
      recipe->setMethod(makeCameraMethod(*device, method).take());
    expectSamePictures({&one, 1}, cameraFromOrbit({20, 10, 6, {0.7, 1.1, 0}, 35}, 361, 503));
  }
  still_->recipe->setMethod(nullptr);  // must be destroyed before the device
}

}  // namespace
}  // namespace fourdvt::render

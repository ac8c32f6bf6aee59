// SPDX-License-Identifier: Apache-2.0
// Shared corners draw the same picture as separate ones, bit by bit.
#include <numeric>

#include "gl_fixture.h"
#include "mannequin.h"
#include "render/passes.h"

namespace fourdvt::render {
namespace {

using testing::Mannequin;

constexpr int kMembers = 2;

class SharedTest : public testing::GlFixture {
 protected:
  void SetUp() override {
    GlFixture::SetUp();
    // Two members of three layers each, with different labels.
    scene_.setLayers(kMembers * 3, 64);
    scene_.character.layer_count = 3;
    scene_.labels = mannequin_.labels(0);
    const std::vector<uint8_t> turned = mannequin_.labels(90);
    scene_.labels.insert(scene_.labels.end(), turned.begin(), turned.end());
    model_ = CharacterModel::create(*device, scene_.character, scene_.mesh).take();
    model_.setPositions(*device, mannequin_.posed(1));
    picture_ =
        createPicture(*device, scene_.rendition.width, scene_.rendition.height, PictureTextures::Kind::Rgba).take();
    mannequin_.scene.rendition = scene_.rendition;
    const Image image = mannequin_.picture();
    device->updateTexture(picture_.rgba.id(), {.width = image.width, .height = image.height}, image.pixels.data());
    appearance_ = Appearance::create(*device, model_, kMembers).take();
    appearance_.setLayout(scene_.rendition);
    recipe_ = Recipe::create(*device).take();
  }
  void TearDown() override {
    recipe_.reset();
    model_ = {};
    appearance_ = {};
    picture_ = {};
    GlFixture::TearDown();
  }

  Image draw(const Figure& figure, const DrawOptions& options) {
    const View view = viewFromCamera(cameraFromOrbit({30, 10, 4, {0, 0.9, 0}, 35}, 300, 400));
    model_.setPositions(*device, mannequin_.posed(1));  // renders a new shadow map
    Image out = testing::drawnImage(*device, view, [&](gpu::TargetId target) {
      return recipe_->draw({&figure, 1}, nullptr, view, options, target);
    });
    remember(out);
    return out;
  }

  void expectSharingChangesNothing(const Figure& figure, const DrawOptions& options = {}) {
    const Image shared = draw(figure, options);
    std::vector<uint32_t> each(3 * model_.face_count);
    std::iota(each.begin(), each.end(), 0u);
    device->updateIndices(appearance_.corners.id(), each);
    EXPECT_EQ(draw(figure, options).pixels, shared.pixels);
  }

  Mannequin mannequin_{12000};  // so fine that labels continue across its chart seams
  testing::Scene scene_ = mannequin_.scene;
  CharacterModel model_;
  Appearance appearance_;
  PictureTextures picture_;
  std::unique_ptr<Recipe> recipe_;
  const std::vector<float> weights_{0.4f, 0.6f};
  const Look look_{&appearance_, &picture_, weights_};
};

TEST_F(SharedTest, membersAndTheirShadow) {
  appearance_.setFrame(*device, model_, {scene_.labels, {}});
  expectSharingChangesNothing({&model_, {&look_, 1}});
}

TEST_F(SharedTest, alignedMembers) {
  std::vector<glm::vec2> alignment;
  for (const glm::vec3& p : scene_.mesh.positions) alignment.emplace_back(0.02f * std::sin(9 * p.y), 0.01f);
  appearance_.setFrame(*device, model_, {scene_.labels, alignment});
  expectSharingChangesNothing({&model_, {&look_, 1}});
}

TEST_F(SharedTest, transitions) {
  appearance_.setFrame(*device, model_, {scene_.labels, {}});
  const Look looks[] = {look_, look_};
  expectSharingChangesNothing({&model_, looks, 0.5f});
}

// Darkness of the ground from above, one pixel per texel of the map, 0…255.
std::vector<int> shadowOf(gpu::Device& device, CharacterModel& model, const Positions& positions) {
  model.setPositions(device, positions);
  auto pass = ShadowPass::create(device).take();
  EXPECT_TRUE(pass.cast(device, 0, model, 0));
  CharacterView above;  // 2.5 m wide, at least the shadow's area
  above.eye_in_character = {0, 0, 0};
  above.clip_from_character = glm::mat4(0.8f, 0, 0, 0, 0, 0, 0, 0, 0, -0.8f, 0, 0, 0, 0, 0, 1);
  const View view{glm::mat4(1), {}, 128, 128};
  const Image image = testing::drawnImage(device, view, [&](gpu::TargetId target) -> Status {
    device.beginPass({.target = target, .clear_color = true});
    pass.drawGround(device, 0, above, 1, false);
    device.endPass();
    return {};
  });
  std::vector<int> out;
  for (size_t i = 3; i < image.pixels.size(); i += 4) out.push_back(image.pixels[i]);
  return out;
}

TEST_F(SharedTest, coarseFacesCastNearlyTheSameShadow) {
  ASSERT_LT(model_.shadow_corner_count, int(model_.face_count));  // a third
  for (const float phase : {0.0f, 0.8f, 1.6f, 2.4f}) {
    auto model = CharacterModel::create(*device, scene_.character, scene_.mesh).take();
    const std::vector<int> coarse = shadowOf(*device, model, mannequin_.posed(phase));
    model.shadow_corners.reset();
    const std::vector<int> fine = shadowOf(*device, model, mannequin_.posed(phase));
    int most = 0, darkest = 0;
    double sum = 0, dark = 0;
    for (size_t i = 0; i < fine.size(); ++i) {
      const int difference = std::abs(fine[i] - coarse[i]);
      most = std::max(most, difference);
      darkest = std::max(darkest, fine[i]);
      sum += difference;
      dark += fine[i];
    }
    EXPECT_GT(darkest, 50);
    EXPECT_LE(most, 6) << "at phase " << phase;
    EXPECT_LT(sum, 0.08 * dark) << "at phase " << phase;
  }
}

TEST_F(SharedTest, coarseMeshesCastTheirOwnShadow) {
  const Mannequin coarse(600);
  const auto model = CharacterModel::create(*device, coarse.scene.character, coarse.scene.mesh).take();
  EXPECT_FALSE(model.shadow_corners);
}

}  // namespace
}  // namespace fourdvt::render

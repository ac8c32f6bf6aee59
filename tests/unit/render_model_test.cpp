// SPDX-License-Identifier: Apache-2.0
// Label packing and seam masks by hand; the recipe's calls on the null device.
#include <gtest/gtest.h>

#include "../render/quad_scene.h"

namespace fourdvt::render {
namespace {

using fourdvt::testing::boxScene;
using fourdvt::testing::quadScene;
using fourdvt::testing::Scene;

TEST(PackLabels, packsFiveBitsASlotAndMarksUnknownCamerasEmpty) {
  const std::vector<glm::uvec3> faces = {{0, 1, 2}, {0, 2, 3}};
  const std::vector<uint8_t> labels = {0, 2, /*slot 1*/ 30, package::kNoCamera, /*slot 2*/ 5, 31};
  std::vector<uint32_t> packed(2, ~0u), masks(4, ~0u);
  packLabels(faces, labels, 3, 31, packed, masks);
  EXPECT_EQ(packed[0] & 0x7fff, 0u | 30u << 5 | 5u << 10);
  EXPECT_EQ(packed[1] & 0x7fff, 2u | 31u << 5 | 31u << 10);
  std::fill(packed.begin(), packed.end(), ~0u);
  packLabels(faces, labels, 3, 4, packed, masks);  // four cameras only: 30 and 5 do not exist
  EXPECT_EQ(packed[0] & 0x7fff, 0u | 31u << 5 | 31u << 10);
}

TEST(PackLabels, aVertexKeepsTheCamerasOfAllItsFaces) {
  // A strip of three faces; vertices 1, 2 are in faces 0 and 1 (2 also in face 2), 3 in 1 and 2, 0 and 4 in one face.
  const std::vector<glm::uvec3> faces = {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}};
  const std::vector<uint8_t> labels = {0, 1, 1, /*slot 1*/ 1, 2, package::kNoCamera};
  std::vector<uint32_t> packed(3, ~0u), masks(5, ~0u);
  packLabels(faces, labels, 2, 3, packed, masks);
  EXPECT_EQ(masks[0], 0b011u);  // {0,1}
  EXPECT_EQ(masks[1], 0b010u);  // {0,1} and {1,2}
  EXPECT_EQ(masks[2], 0b010u);  // {0,1}, {1,2} and {1}
  EXPECT_EQ(masks[3], 0b010u);  // {1,2} and {1}
  EXPECT_EQ(masks[4], 0b010u);  // {1}
}

struct Drawn {
  std::unique_ptr<gpu::Device> device = gpu::createNullDevice();
  CharacterModel model;
  PictureTextures picture;
  std::unique_ptr<Recipe> recipe;
  gpu::Texture color;
  gpu::Target target;

  Drawn(const Scene& scene, PictureTextures::Kind kind) {
    model = CharacterModel::create(*device, scene.character, scene.mesh).take();
    model.setLayout(scene.rendition);
    picture = createPicture(*device, scene.rendition.width, scene.rendition.height, kind).take();
    recipe = Recipe::create(*device).take();
    color = gpu::makeTexture(*device, {.width = 64, .height = 48}).take();
    target = gpu::makeTarget(*device, {.colors = {color.id()}}).take();
  }
  Status draw(const RecipeOptions& options = {}) {
    const auto camera = fourdvt::testing::lookAt({0, 1, 3}, {0, 1, 0}, 64, 48, 50);
    return recipe->draw(model, picture, viewFromCamera(camera), options, target.id());
  }
};

TEST(Recipe, drawsFiveTimesThenTwiceForTheSameGeometryAndLeaksNothing) {
  Scene scene = boxScene(0.2f, 1.8f);
  scene.setLayers(2, 32);
  std::unique_ptr<gpu::Device> device;
  {
    Drawn drawn(scene, PictureTextures::Kind::I420);
    drawn.model.setGeometry(*drawn.device, {scene.mesh.positions, scene.labels});
    drawn.device->resetCounters();
    ASSERT_TRUE(drawn.draw());
    EXPECT_EQ(drawn.device->counters().draws, 5u);  // cast, blur, blur, ground, character
    EXPECT_EQ(drawn.device->counters().vertices, 36u + 3 + 3 + 6 + 36);
    EXPECT_EQ(drawn.device->counters().passes, 4u);
    ASSERT_TRUE(drawn.draw());
    EXPECT_EQ(drawn.device->counters().draws, 7u);
    EXPECT_EQ(drawn.device->counters().uploaded_bytes, 0u);
    RecipeOptions plain;
    plain.ground_shadow = false;
    ASSERT_TRUE(drawn.draw(plain));
    EXPECT_EQ(drawn.device->counters().draws, 8u);
    EXPECT_EQ(drawn.device->takeErrors(), "");
    device = std::move(drawn.device);
    // Owners go before the device.
    drawn.model = {};
    drawn.picture = {};
    drawn.recipe.reset();
    drawn.target.reset();
    drawn.color.reset();
  }
  EXPECT_EQ(device->counters().live_textures, 0u);
  EXPECT_EQ(device->counters().live_texture_bytes, 0u);
  EXPECT_EQ(device->counters().live_targets, 0u);
  EXPECT_EQ(device->counters().live_programs, 0u);
  EXPECT_EQ(device->takeErrors(), "");
}

TEST(Recipe, makesOneProgramForEachLayerCountKindAndDebugView) {
  Scene scene = quadScene({0, 1}, 0.5f);
  scene.setLayers(2, 32);
  Drawn drawn(scene, PictureTextures::Kind::Rgba);
  drawn.model.setGeometry(*drawn.device, {scene.mesh.positions, scene.labels});
  ASSERT_TRUE(drawn.draw());
  const uint64_t programs = drawn.device->counters().live_programs;
  ASSERT_TRUE(drawn.draw());
  EXPECT_EQ(drawn.device->counters().live_programs, programs);
  RecipeOptions debug;
  debug.debug = DebugView::Weights;
  ASSERT_TRUE(drawn.draw(debug));
  EXPECT_EQ(drawn.device->counters().live_programs, programs + 1);
}

TEST(Recipe, refusesAModelThatIsNotReady) {
  Scene scene = quadScene({0, 1}, 0.5f);
  scene.setLayers(2, 32);
  Drawn drawn(scene, PictureTextures::Kind::Rgba);
  EXPECT_EQ(drawn.draw().error().id, ErrorId::InvalidArgument);  // no geometry
  drawn.model.setGeometry(*drawn.device, {scene.mesh.positions, scene.labels});
  EXPECT_TRUE(drawn.draw());
  scene.rendition.layers.pop_back();
  drawn.model.setLayout(scene.rendition);
  EXPECT_EQ(drawn.draw().error().id, ErrorId::InvalidArgument);  // one layer short
  RecipeOptions options;
  options.debug_layer = 2;
  EXPECT_EQ(drawn.draw(options).error().id, ErrorId::InvalidArgument);
}

TEST(CharacterModel, knowsAClosedSurface) {
  auto device = gpu::createNullDevice();
  Scene box = boxScene(0.2f, 1), quad = quadScene({0, 1}, 0.5f);
  box.setLayers(1, 8);
  quad.setLayers(1, 8);
  EXPECT_TRUE(CharacterModel::create(*device, box.character, box.mesh).value().closed_surface);
  EXPECT_FALSE(CharacterModel::create(*device, quad.character, quad.mesh).value().closed_surface);
}

TEST(CharacterModel, refusesAMeshWithoutFacesOrTooLarge) {
  auto device = gpu::createNullDevice();
  Scene scene = quadScene({0, 1}, 0.5f);
  scene.setLayers(1, 8);
  package::BaseMesh empty;
  EXPECT_EQ(CharacterModel::create(*device, scene.character, empty).error().id, ErrorId::GpuFailure);
  scene.mesh.topology.face_vertices.resize(4096 * 256, glm::uvec3(0, 1, 2));
  EXPECT_EQ(CharacterModel::create(*device, scene.character, scene.mesh).error().id, ErrorId::GpuFailure);
}

}  // namespace
}  // namespace fourdvt::render

// SPDX-License-Identifier: Apache-2.0
// Label packing and seam masks, computed by hand; the recipe's calls on the null device.
#include <gtest/gtest.h>

#include <cmath>

#include "../../render/quad_scene.h"
#include "../live_objects.h"

namespace fourdvt::render {
namespace {

using fourdvt::testing::boxScene;
using fourdvt::testing::quadScene;
using fourdvt::testing::Scene;

TEST(PackLabels, packsFiveBitsPerRankAndMarksUnknownCamerasEmpty) {
  const std::vector<glm::uvec3> faces = {{0, 1, 2}, {0, 2, 3}};
  const std::vector<uint8_t> labels = {0, 2, /*rank 1*/ 30, package::kNoCamera, /*rank 2*/ 5, 31};
  std::vector<uint32_t> packed(2, ~0u), masks(4, ~0u);
  packLabels(faces, labels, 31, packed, masks);
  EXPECT_EQ(packed[0] & 0x7fff, 0u | 30u << 5 | 5u << 10);
  EXPECT_EQ(packed[1] & 0x7fff, 2u | 31u << 5 | 31u << 10);
  std::fill(packed.begin(), packed.end(), ~0u);
  packLabels(faces, labels, 4, packed, masks);  // of four cameras only: 30 and 5 do not exist
  EXPECT_EQ(packed[0] & 0x7fff, 0u | 31u << 5 | 31u << 10);
}

TEST(PackLabels, aVertexKeepsTheCamerasOfAllItsFaces) {
  // A strip of three faces; vertices 1, 2 are in faces 0 and 1 (2 also in face 2), 3 in 1 and 2, 0 and 4 in one face.
  const std::vector<glm::uvec3> faces = {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}};
  const std::vector<uint8_t> labels = {0, 1, 1, /*rank 1*/ 1, 2, package::kNoCamera};
  std::vector<uint32_t> packed(3, ~0u), masks(5, ~0u);
  packLabels(faces, labels, 3, packed, masks);
  EXPECT_EQ(masks[0], 0b011u);  // {0,1}
  EXPECT_EQ(masks[1], 0b010u);  // {0,1} and {1,2}
  EXPECT_EQ(masks[2], 0b010u);  // {0,1}, {1,2} and {1}
  EXPECT_EQ(masks[3], 0b010u);  // {1,2} and {1}
  EXPECT_EQ(masks[4], 0b010u);  // {1}
}

struct Drawn {
  std::unique_ptr<gpu::Device> device = gpu::createNullDevice();
  PlainFigure figure;
  PictureTextures picture;
  std::unique_ptr<Recipe> recipe;
  gpu::Texture color;
  gpu::Target target;

  Drawn(const Scene& scene, PictureTextures::Kind kind) {
    figure = PlainFigure::create(*device, scene.character, scene.mesh).take();
    figure.setLayout(scene.rendition);
    picture = createPicture(*device, scene.rendition.width, scene.rendition.height, kind).take();
    recipe = Recipe::create(*device).take();
    color = gpu::makeTexture(*device, {.width = 64, .height = 48}).take();
    target = gpu::makeTarget(*device, {.colors = {color.id()}}).take();
  }
  Status draw(const RecipeOptions& options = {}) {
    const auto camera = fourdvt::testing::lookAt({0, 1, 3}, {0, 1, 0}, 64, 48, 50);
    return figure.draw(*recipe, picture, viewFromCamera(camera), options, target.id());
  }
};

TEST(Recipe, drawsFiveTimesThenTwiceForTheSameGeometryAndLeaksNothing) {
  Scene scene = boxScene(0.2f, 1.8f);
  scene.setLayers(2, 32);
  std::unique_ptr<gpu::Device> device;
  {
    Drawn drawn(scene, PictureTextures::Kind::I420);
    drawn.figure.setFrame(*drawn.device, scene.mesh.positions, scene.labels);
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
    // Must be destroyed before the device.
    drawn.figure = {};
    drawn.picture = {};
    drawn.recipe.reset();
    drawn.target.reset();
    drawn.color.reset();
  }
  fourdvt::testing::expectNothingLives(*device);
}

TEST(Recipe, makesOneProgramForEachLayerCountKindAndDebugView) {
  Scene scene = quadScene({0, 1}, 0.5f);
  scene.setLayers(2, 32);
  Drawn drawn(scene, PictureTextures::Kind::Rgba);
  drawn.figure.setFrame(*drawn.device, scene.mesh.positions, scene.labels);
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
  drawn.figure.setFrame(*drawn.device, scene.mesh.positions, scene.labels);
  EXPECT_TRUE(drawn.draw());
  scene.rendition.layers.pop_back();
  drawn.figure.setLayout(scene.rendition);
  EXPECT_EQ(drawn.draw().error().id, ErrorId::InvalidArgument);  // one layer short
  RecipeOptions options;
  options.debug_layer = -1;
  EXPECT_EQ(drawn.draw(options).error().id, ErrorId::InvalidArgument);
}

TEST(Recipe, drawsTheLastLayerOfAFigureThatHasNotTheWantedOne) {
  Scene scene = quadScene({0, 1}, 0.5f);
  scene.setLayers(2, 32);
  Drawn drawn(scene, PictureTextures::Kind::Rgba);
  drawn.figure.setFrame(*drawn.device, scene.mesh.positions, scene.labels);
  RecipeOptions options;
  options.debug = DebugView::Layer;
  options.debug_layer = 3;
  EXPECT_TRUE(drawn.draw(options));
}

// A class of two members on the null device, drawn like any figure.
struct DrawnClass {
  Scene scene = boxScene(0.2f, 1.8f);
  std::unique_ptr<gpu::Device> device = gpu::createNullDevice();
  CharacterModel model;
  Appearance appearance;
  PictureTextures picture;
  std::unique_ptr<Recipe> recipe;
  gpu::Texture color;
  gpu::Target target;
  std::vector<float> weights{0.5f, 0.5f};
  View view = viewFromCamera(fourdvt::testing::lookAt({0, 1, 3}, {0, 1, 0}, 64, 48, 50));
  DrawOptions options;

  DrawnClass() {
    scene.setLayers(4, 32);
    scene.character.layer_count = 2;
    model = CharacterModel::create(*device, scene.character, scene.mesh).take();
    model.setPositions(*device, scene.mesh.positions);
    appearance = Appearance::create(*device, model, 2).take();
    appearance.setLayout(scene.rendition);
    appearance.setFrame(*device, model, {scene.labels, {}});
    picture = createPicture(*device, 128, 32, PictureTextures::Kind::I420).take();
    recipe = Recipe::create(*device).take();
    color = gpu::makeTexture(*device, {.width = 64, .height = 48}).take();
    target = gpu::makeTarget(*device, {.colors = {color.id()}}).take();
  }
  Look look() const { return {&appearance, &picture, weights}; }
  Status draw(std::span<const Figure> figures) {
    device->resetCounters();
    return recipe->draw(figures, nullptr, view, options, target.id());
  }
  Status draw(const Figure& figure) { return draw(std::span(&figure, 1)); }
  ErrorId refusal(const Figure& figure) { return draw(figure).error().id; }
};

TEST(Recipe, blendsMembersInOneDrawAndLooksThroughPictures) {
  DrawnClass drawn;
  const Look looks[] = {drawn.look(), drawn.look()};
  Figure figure{&drawn.model, {looks, 1}};
  ASSERT_TRUE(drawn.draw(figure));
  EXPECT_EQ(drawn.device->counters().draws, 5u);  // cast, blur, blur, ground, character
  figure.looks = looks;
  figure.fade = 0.5f;
  ASSERT_TRUE(drawn.draw(figure));
  EXPECT_EQ(drawn.device->counters().draws, 5u);  // two looks, mix, ground, character
  figure.fade = 1;
  ASSERT_TRUE(drawn.draw(figure));
  EXPECT_EQ(drawn.device->counters().draws, 2u);  // ground, character: the second look alone
  EXPECT_EQ(drawn.device->takeErrors(), "");
}

TEST(Recipe, figuresShareAllButTheirShadows) {
  DrawnClass drawn;
  const Look look = drawn.look();
  const std::vector<Figure> figures(3, Figure{&drawn.model, {&look, 1}});
  ASSERT_TRUE(drawn.draw(std::span(figures).first(1)));
  const gpu::Counters one = drawn.device->counters();
  ASSERT_TRUE(drawn.draw(figures));
  EXPECT_EQ(drawn.device->counters().live_programs, one.live_programs);
  EXPECT_EQ(drawn.device->counters().live_textures, one.live_textures + 2);
  EXPECT_EQ(drawn.device->counters().draws, 2 * 3u + 3 + 3);  // casts of two, ground, characters
  ASSERT_TRUE(drawn.draw(std::span<const Figure>()));
  EXPECT_EQ(drawn.device->counters().draws, 0u);
  EXPECT_EQ(drawn.device->takeErrors(), "");
}

TEST(Recipe, refusesWhatItCannotDraw) {
  DrawnClass drawn;
  const Look look = drawn.look(), looks[3] = {look, look, look};
  const Figure good{&drawn.model, {&look, 1}};
  ASSERT_TRUE(drawn.draw(good));
  Figure bad = good;
  bad.model = nullptr;
  EXPECT_EQ(drawn.refusal(bad), ErrorId::InvalidArgument);
  for (size_t count : {0, 3}) {
    bad = good;
    bad.looks = std::span(looks).first(count);
    EXPECT_EQ(drawn.refusal(bad), ErrorId::InvalidArgument) << count;
  }
  for (float fade : {-0.1f, 1.1f, NAN}) {
    bad = good;
    bad.fade = fade;
    EXPECT_EQ(drawn.refusal(bad), ErrorId::InvalidArgument) << fade;
  }
  bad = good;
  bad.world_from_character = glm::mat4(0);
  EXPECT_EQ(drawn.refusal(bad), ErrorId::InvalidArgument);
  for (const std::vector<float>& weights :
       {std::vector<float>{}, {1}, {0.5f, 0.6f}, {1.5f, -0.5f}, {NAN, 1}, {0.5f, 0.25f, 0.25f}}) {
    drawn.weights = weights;
    const Look wrong = drawn.look();
    bad = good;
    bad.looks = {&wrong, 1};
    EXPECT_EQ(drawn.refusal(bad), ErrorId::InvalidArgument);
  }
  drawn.options.align = Align::Flow;
  EXPECT_EQ(drawn.refusal(good), ErrorId::Unsupported);
  EXPECT_EQ(drawn.device->takeErrors(), "");
}

TEST(Appearance, refusesTooManyMembers) {
  DrawnClass drawn;
  for (int members : {0, package::kMaxMembers + 1})
    EXPECT_EQ(Appearance::create(*drawn.device, drawn.model, members).error().id, ErrorId::InvalidArgument);
}

TEST(SceneMesh, needsFiniteNumbers) {
  auto device = gpu::createNullDevice();
  for (const float wrong : {NAN, INFINITY, -INFINITY}) {
    std::vector<SceneCorner> position(3), color(3);
    position[1].position.y = color[2].color.b = wrong;
    EXPECT_EQ(makeSceneMesh(*device, position, false).error().id, ErrorId::InvalidArgument);
    EXPECT_EQ(makeSceneMesh(*device, color, false).error().id, ErrorId::InvalidArgument);
  }
}

TEST(SceneMesh, needsWholeTriangles) {
  auto device = gpu::createNullDevice();
  for (size_t corners : {0, 4})
    EXPECT_EQ(makeSceneMesh(*device, std::vector<SceneCorner>(corners), false).error().id, ErrorId::InvalidArgument);
  EXPECT_EQ(makeSceneMesh(*device, std::vector<SceneCorner>(6), true).value().corner_count, 6);
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

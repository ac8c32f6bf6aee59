// SPDX-License-Identifier: Apache-2.0
// Several figures and their surroundings: placement, depth, occluders, background, shadows under the feet.
#include "../unit/scaled.h"
#include "member_quad.h"

namespace fourdvt::render {
namespace {

using testing::expectColor;
using testing::plainOptions;
using testing::Still;

constexpr float kWhole[] = {1};
const glm::dvec3 kRed(220, 30, 40), kGreen(30, 210, 60);

glm::mat4 moved(const glm::vec3& by) {
  glm::mat4 m(1);
  m[3] = glm::vec4(by, 1);
  return m;
}

glm::mat4 turned(float radians) {
  glm::mat4 m(1);
  m[0] = {std::cos(radians), 0, -std::sin(radians), 0};
  m[2] = {std::sin(radians), 0, std::cos(radians), 0};
  return m;
}

class Stage : public testing::GlFixture {
 protected:
  // Scene of one constant colour, with camera 0 in its only rank.
  std::unique_ptr<Still> still(testing::Scene scene, const glm::dvec3& color) {
    scene.setLayers(1, 16);
    for (uint32_t face = 0; face < scene.mesh.topology.faceCount(); ++face) scene.setLabel(0, face, 0);
    auto out = std::make_unique<Still>(*device, scene, PictureTextures::Kind::Rgba);
    out->uploadRgba(testing::constantLayers(scene, {color}));
    looks_.push_back(std::make_unique<Look>(Look{&out->figure.appearance, &out->picture, kWhole}));
    return out;
  }
  Figure placed(const Still& still, const glm::mat4& world_from_character) const {
    for (const auto& look : looks_)
      if (look->picture == &still.picture) return {&still.figure.model, {look.get(), 1}, 0, world_from_character};
    return {};
  }
  Image draw(Recipe& recipe, const std::vector<Figure>& figures, const Scene* scene, const PinholeCamera& camera,
             const RecipeOptions& options) {
    const View view = viewFromCamera(camera, lengthScalesOf(figures));
    Image image = testing::drawnImage(
        *device, view, [&](gpu::TargetId target) { return recipe.draw(figures, scene, view, {options}, target); });
    remember(image);
    return image;
  }
  // Two triangles facing +Z.
  std::vector<SceneCorner> wall(const glm::vec2& centre, float half, float z, const glm::vec3& color) const {
    const glm::vec3 a(centre.x - half, centre.y - half, z), b(centre.x + half, centre.y + half, z);
    return {{a, color}, {{b.x, a.y, z}, color}, {b, color}, {a, color}, {b, color}, {{a.x, b.y, z}, color}};
  }
  std::vector<std::unique_ptr<Look>> looks_;
  const PinholeCamera front = testing::lookAt({0, 1, 3}, {0, 1, 0}, 96, 96, 60);
};

TEST_F(Stage, theNearerOfTwoFiguresIsSeenInAnyOrder) {
  const auto red = still(testing::quadScene({0, 1}, 0.5f), kRed),
             green = still(testing::quadScene({0, 1}, 0.5f), kGreen);
  const Figure near = placed(*red, moved({0.4f, 0, 0.5f})), far = placed(*green, glm::mat4(1));
  for (const auto& figures : {std::vector{near, far}, {far, near}}) {
    const Image picture = draw(*red->recipe, figures, nullptr, front, plainOptions());
    expectColor(picture, 48, 48, kRed, 1);
    expectColor(picture, 41, 48, kGreen, 1);
    EXPECT_EQ(picture.at(5, 48)[3], 0);
  }
}

// Weights and rays use the character frame: a placed figure looks like the unplaced one from the moved camera.
TEST_F(Stage, aPlacedFigureLooksAsFromACameraMovedTheOtherWay) {
  testing::MemberQuad quad(*device, 1, 2, [](int, int rank) { return uint8_t(rank); });
  quad.paintTiles(*device, {kRed, kGreen});
  const auto recipe = Recipe::create(*device).take();
  const Look look = quad.look(kWhole);
  const glm::mat4 placement = moved({2, 0.3f, -1}) * turned(0.8f);
  const PinholeCamera camera = testing::lookAt({0.4, 1.3, 3}, {0, 1, 0}, 96, 96, 80);
  PinholeCamera moved_camera = camera;
  moved_camera.cam_from_world = camera.cam_from_world * glm::inverse(glm::dmat4(placement));
  const Image plain = draw(*recipe, {{&quad.model, {&look, 1}}}, nullptr, camera, plainOptions());
  const Image placed = draw(*recipe, {{&quad.model, {&look, 1}, 0, placement}}, nullptr, moved_camera, plainOptions());
  EXPECT_EQ(plain.at(48, 48)[3], 255);
  int different = 0;  // pixels: edges may round to the other side
  for (size_t i = 0; i < plain.pixels.size(); i += 4)
    for (int c = 0; c < 4; ++c)
      if (std::abs(plain.pixels[i + c] - placed.pixels[i + c]) > 1) ++different, c = 4;
  EXPECT_LE(different, 4);
}

TEST_F(Stage, meshesHideFiguresAndOccludersShowTheBackground) {
  const auto red = still(testing::quadScene({0, 1}, 0.5f), kRed);
  Scene scene;
  auto paper = gpu::makeTexture(*device, {.width = 1, .height = 2}).take();
  const uint8_t rows[] = {0, 0, 255, 255, 0, 80, 80, 255};  // blue above
  device->updateTexture(paper.id(), {.width = 1, .height = 2}, rows);
  scene.background = paper.id();
  scene.meshes.push_back(makeSceneMesh(*device, wall({-0.25f, 1}, 0.2f, 0.5f, {0, 0, 0}), true).take());
  scene.meshes.push_back(makeSceneMesh(*device, wall({0.25f, 1}, 0.2f, 0.5f, {1, 1, 0}), false).take());
  scene.meshes.push_back(makeSceneMesh(*device, wall({0, 1}, 2, -0.5f, {0, 0, 0}), true).take());  // behind
  const Image picture = draw(*red->recipe, {placed(*red, glm::mat4(1))}, &scene, front, plainOptions());
  expectColor(picture, 48, 5, {0, 0, 255}, 1);
  expectColor(picture, 48, 90, {0, 80, 80}, 1);
  expectColor(picture, 48, 48, kRed, 1);
  expectColor(picture, 42, 46, {0, 0, 255}, 1);    // hidden
  expectColor(picture, 54, 48, {255, 255, 0}, 1);  // the yellow wall
  expectColor(picture, 50, 40, kRed, 1);
}

int alphaAt(const Image& picture, const PinholeCamera& camera, const glm::dvec3& point_in_world) {
  const glm::dvec3 pixel = camera.project(point_in_world);
  return picture.at(int(pixel.x), int(pixel.y))[3];
}

TEST_F(Stage, withoutFiguresTheSceneIsDrawn) {
  const auto recipe = Recipe::create(*device).take();
  Scene scene;
  scene.meshes.push_back(makeSceneMesh(*device, wall({0, 1}, 0.5f, 0, {1, 1, 0}), false).take());
  const Image picture = draw(*recipe, {}, &scene, front, {});
  expectColor(picture, 48, 48, {255, 255, 0}, 1);
  EXPECT_EQ(picture.at(2, 2)[3], 0);
}

TEST_F(Stage, everyFigureHasItsShadowUnderItsFeet) {
  const auto box = still(testing::boxScene(0.15f, 1.6f), {200, 160, 120});
  const PinholeCamera camera = cameraFromOrbit({0, 30, 6, {0, 0.5, 0}, 40}, 320, 240);
  const auto alpha = [&](const Image& picture, const glm::dvec3& point) { return alphaAt(picture, camera, point); };
  RecipeOptions options;
  const Image one = draw(*box->recipe, {placed(*box, moved({1.2f, 0, 0}))}, nullptr, camera, options);
  EXPECT_GT(alpha(one, {1.4, 0, 0.1}), 30);
  EXPECT_EQ(alpha(one, {0.2, 0, 0.1}), 0);
  const Image two =
      draw(*box->recipe, {placed(*box, moved({1.2f, 0, 0})), placed(*box, glm::mat4(1))}, nullptr, camera, options);
  EXPECT_NEAR(alpha(two, {1.4, 0, 0.1}), alpha(one, {1.4, 0, 0.1}), 2);
  EXPECT_NEAR(alpha(two, {0.2, 0, 0.1}), alpha(one, {1.4, 0, 0.1}), 10);
}

TEST_F(Stage, aFigureOfAnySizeHasTheSameShadow) {
  std::vector<std::unique_ptr<Still>> boxes;
  const auto picture = [&](double scale) {
    testing::Scene scene = testing::boxScene(float(scale * 0.15), float(scale * 1.6));
    scene.character.length_scale = scale;
    boxes.push_back(still(scene, {200, 160, 120}));
    const PinholeCamera camera = cameraFromOrbit({0, 30, 6 * scale, {0, 0.5 * scale, 0}, 40}, 320, 240);
    return draw(*boxes.back()->recipe, {placed(*boxes.back(), glm::mat4(1))}, nullptr, camera, {});
  };
  const Image person = picture(1);
  const PinholeCamera camera = cameraFromOrbit({0, 30, 6, {0, 0.5, 0}, 40}, 320, 240);
  EXPECT_GT(alphaAt(person, camera, {0.2, 0, 0.1}), 30);
  for (const double scale : {0.05, 20.0})
    EXPECT_LT(testing::shareThatDiffers(person, picture(scale), 3), 0.005) << scale;
}

TEST_F(Stage, theShadowLiesOnTheScenesGroundBehindOccluders) {
  const auto box = still(testing::boxScene(0.15f, 1.6f), {200, 160, 120});
  const PinholeCamera camera = cameraFromOrbit({0, 30, 5, {0, 0.5, 0}, 40}, 240, 240);
  const auto alpha = [&](const Image& picture, const glm::dvec3& point) { return alphaAt(picture, camera, point); };
  RecipeOptions options;
  options.shadow_strength = 0.8f;
  Scene scene;
  scene.ground_y_m = 0.4f;
  const Figure figure = placed(*box, moved({0, 0.4f, 0}));
  const Image raised = draw(*box->recipe, {figure}, &scene, camera, options);
  const int under_feet = alpha(raised, {0.2, 0.4, 0.1});
  EXPECT_GT(under_feet, 40);
  scene.ground_y_m = 0.1f;  // in the air: weaker, lower
  const Image floating = draw(*box->recipe, {figure}, &scene, camera, options);
  EXPECT_LT(alpha(floating, {0.2, 0.1, 0.1}), under_feet - 15);
  EXPECT_GT(alpha(floating, {0.2, 0.1, 0.1}), 0);
  scene.ground_y_m = 0.4f;
  const glm::dvec3 ground(0.2, 0.4, 0.1), eye = camera.centreInWorld();
  const glm::dvec3 before = glm::mix(ground, eye, 0.05);
  scene.meshes.push_back(
      makeSceneMesh(*device, wall({before.x, before.y}, 0.05f, float(before.z), {0, 0, 0}), true).take());
  EXPECT_EQ(alpha(draw(*box->recipe, {figure}, &scene, camera, options), ground), 0);
}

TEST_F(Stage, aFloorOfTheSceneCarriesTheShadow) {
  const auto box = still(testing::boxScene(0.15f, 1.6f), {200, 160, 120});
  Scene scene;
  const glm::vec3 white(1), a(-9, 0, 9), b(9, 0, 9), c(9, 0, -9), d(-9, 0, -9);
  scene.meshes.push_back(
      makeSceneMesh(*device,
                    std::vector<SceneCorner>{{a, white}, {b, white}, {c, white}, {a, white}, {c, white}, {d, white}},
                    false)
          .take());
  for (double elevation : {4.0, 30.0}) {
    const PinholeCamera camera = cameraFromOrbit({0, elevation, 5, {0, 0.5, 0}, 40}, 240, 240);
    const Image picture = draw(*box->recipe, {placed(*box, glm::mat4(1))}, &scene, camera, {});
    const glm::dvec3 p = camera.project({0.2, 0, 0.1}), far = camera.project({1.2, 0, 0});
    EXPECT_LT(picture.at(int(p.x), int(p.y))[0], 225) << elevation;
    EXPECT_EQ(picture.at(int(far.x), int(far.y))[0], 255) << elevation;
  }
}

// Faces of 64 x 64 texels side by side: -x red, +x green, floor grey, ceiling white, +z yellow; -z is blue on the left
// and black on the right, seen from inside.
Scene paintedRoom(gpu::Device& device) {
  package::Room room;
  room.box = {{-2, 0, -2}, {2, 3, 2}};
  room.width = 6 * 64;
  room.height = 64;
  for (int f = 0; f < 6; ++f) room.faces[size_t(f)] = {64 * f, 0, 64, 64};
  const glm::u8vec3 colours[] = {{200, 0, 0},     {0, 200, 0}, {120, 120, 120},
                                 {255, 255, 255}, {0, 0, 220}, {220, 220, 0}};
  Image picture(room.width, room.height, 4, 255);
  for (int y = 0; y < room.height; ++y)
    for (int x = 0; x < room.width; ++x) {
      const bool right = x >= 4 * 64 + 32 && x < 5 * 64;
      for (int c = 0; c < 3; ++c) picture.at(x, y)[c] = right ? 0 : colours[x / 64][c];
    }
  Scene scene;
  EXPECT_TRUE(setRoom(device, room, scene).ok());
  device.updateTexture(scene.room_picture.id(), {.width = room.width, .height = room.height}, picture.pixels.data());
  device.generateMipmaps(scene.room_picture.id());
  return scene;
}

TEST_F(Stage, aRoomIsSeenFromItsInsideOnly) {
  const auto recipe = Recipe::create(*device).take();
  const Scene scene = paintedRoom(*device);
  const auto seen = [&](const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& color, int x = 48, int y = 48) {
    const Image picture = draw(*recipe, {}, &scene, testing::lookAt(from, to, 96, 96, 60), plainOptions());
    expectColor(picture, x, y, color, 1);
    EXPECT_EQ(picture.at(x, y)[3], 255);
  };
  const glm::dvec3 middle(0, 1.5, 0), blue(0, 0, 220), black(0, 0, 0);
  seen(middle, {-2, 1.5, 0}, {200, 0, 0});
  seen(middle, {2, 1.5, 0}, {0, 200, 0});
  seen(middle, {0.01, 0, 0}, {120, 120, 120});
  seen(middle, {0.01, 3, 0}, {255, 255, 255});
  seen(middle, {0, 1.5, 2}, {220, 220, 0});
  seen(middle, {0, 1.5, -2}, blue, 30);
  seen(middle, {0, 1.5, -2}, black, 66);
  // From outside, walls in front of the room are invisible.
  seen({0, 1.5, 6}, middle, blue, 40);
  seen({0, 1.5, 6}, middle, black, 56);
  const Image outside = draw(*recipe, {}, &scene, testing::lookAt({0, 1.5, 6}, middle, 96, 96, 60), plainOptions());
  EXPECT_EQ(outside.at(2, 48)[3], 0);
}

TEST_F(Stage, theShadowFallsOnTheRoomsFloorAndOneDrawIsAdded) {
  const auto box = still(testing::boxScene(0.15f, 1.6f), {200, 160, 120});
  const PinholeCamera camera = cameraFromOrbit({0, 30, 3.4, {0, 0.5, 0}, 40}, 240, 240);
  const Scene scene = paintedRoom(*device), nothing;
  const auto draws = [&](const Scene* what, const RecipeOptions& options, Image& out) {
    device->resetCounters();
    out = draw(*box->recipe, {placed(*box, glm::mat4(1))}, what, camera, options);
    return device->counters().draws;
  };
  RecipeOptions options, unshaded;
  unshaded.ground_shadow = false;
  Image with, without, plain;
  const uint64_t first = draws(&scene, options, with);  // casts the shadow
  EXPECT_GT(first, 1u);
  const uint64_t again = draws(&scene, options, with);
  EXPECT_EQ(again, draws(&nothing, options, plain) + 1);
  draws(&scene, unshaded, without);
  const auto level = [&](const Image& picture, const glm::dvec3& point) {
    const glm::dvec3 pixel = camera.project(point);
    return int(picture.at(int(pixel.x), int(pixel.y))[0]);
  };
  EXPECT_EQ(level(without, {0.2, 0, 0.1}), 120);
  EXPECT_LT(level(with, {0.2, 0, 0.1}), 105);
  EXPECT_NEAR(level(with, {1.2, 0, 0.6}), 120, 1);
}

}  // namespace
}  // namespace fourdvt::render

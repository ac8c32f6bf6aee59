// SPDX-License-Identifier: Apache-2.0
// Figures from cameras in the recipe: the picture that the benchmark gives of the same cameras, tiles that lie anywhere
// in the decoded picture, what is kept from picture to picture, and what unseen surface shows.
#include <cmath>

#include "gl_fixture.h"
#include "render/cameras/camera_method.h"
#include "render/cameras/fvvr.h"
#include "render/recipe.h"

namespace fourdvt::testing {
namespace {

using glm::dvec3;

constexpr int kSide = 64, kPicture = 256;

class CamerasTest : public GlFixture {
 protected:
  void SetUp() override {
    GlFixture::SetUp();
    picture_ = render::createPicture(*device, kPicture, kPicture, render::PictureTextures::Kind::Rgba).take();
    recipe_ = render::Recipe::create(*device).take();
    recipe_->setMethod(render::makeCameraMethod(*device, "fvvr").take());
    options_.recipe = {.background = {0, 0, 0, 0}, .ground_shadow = false};
    options_.method = {.closest = 0, .unseen = render::Unseen::BestFacing, .least_cosine = 0};
  }

  void TearDown() override {
    recipe_.reset();
    model_ = {};
    picture_ = {};
    GlFixture::TearDown();
  }

  void addQuad(dvec3 centre, double half, int cells = 1) {
    const uint32_t first = static_cast<uint32_t>(positions_.size());
    for (int y = 0; y <= cells; ++y)
      for (int x = 0; x <= cells; ++x)
        positions_.emplace_back(centre + half * dvec3(2.0 * x / cells - 1, 1 - 2.0 * y / cells, 0));
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x) {
        const uint32_t a = first + y * (cells + 1) + x, b = a + cells + 1;
        faces_.push_back({a, b, b + 1});
        faces_.push_back({a, b + 1, a + 1});
      }
  }

  void makeModel() {
    package::Character character;
    character.cameras = cameras_;
    character.vertex_count = static_cast<uint32_t>(positions_.size()) + 7;  // frames may have fewer than the most
    character.face_count = static_cast<uint32_t>(faces_.size()) + 5;
    model_ = render::CharacterModel::createForSurfaces(*device, character).take();
    ASSERT_TRUE(model_.setTopology(*device, faces_, static_cast<uint32_t>(positions_.size())));
    model_.setPositions(*device, positions_);
  }

  // Camera pictures into the decoded picture, each at `at` with its whole area.
  void tile(const std::vector<Image>& pictures, const std::vector<glm::ivec2>& at) {
    Image whole(kPicture, kPicture, 4, 77);
    sources_.clear();
    for (size_t c = 0; c < pictures.size(); ++c) {
      for (int y = 0; y < pictures[c].height; ++y)
        for (int x = 0; x < pictures[c].width; ++x)
          for (int k = 0; k < 4; ++k) whole.at(at[c].x + x, at[c].y + y)[k] = pictures[c].at(x, y)[k];
      const glm::vec2 size(pictures[c].width, pictures[c].height);
      sources_.push_back({{0, 0, size}, glm::vec4(at[c], size) / float(kPicture)});
    }
    device->updateTexture(picture_.rgba.id(), {.width = kPicture, .height = kPicture}, whole.pixels.data());
    ++serial_;
  }

  Status drawTo(const PinholeCamera& view, gpu::TargetId target) {
    const render::CameraLook look{cameras_, sources_, &picture_, glm::vec2(kPicture), serial_};
    render::Figure figure;
    figure.model = &model_;
    figure.cameras = &look;
    return recipe_->draw({&figure, 1}, nullptr, render::viewFromCamera(view), options_, target);
  }

  Image still(const PinholeCamera& view) {
    Image image =
        drawnImage(*device, render::viewFromCamera(view), [&](gpu::TargetId target) { return drawTo(view, target); });
    remember(image);
    return image;
  }

  std::vector<glm::uvec3> faces_;
  Positions positions_;
  std::vector<PinholeCamera> cameras_;
  std::vector<render::CameraSource> sources_;
  render::CharacterModel model_;
  render::PictureTextures picture_;
  std::unique_ptr<render::Recipe> recipe_;
  render::DrawOptions options_;
  uint64_t serial_ = 0;
};

// Red rises with x, green with y, and blue is the camera's number.
Image gradient(const PinholeCamera& camera, int number) {
  Image image(camera.width, camera.height, 4, 255);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      uint8_t* p = image.at(x, y);
      p[0] = static_cast<uint8_t>(3 * x), p[1] = static_cast<uint8_t>(3 * y), p[2] = static_cast<uint8_t>(60 * number);
    }
  return image;
}

// Of pixels that both cover whole.
int largestDifference(const Image& a, const Image& b) {
  int largest = 0, compared = 0;
  for (size_t i = 0; i < a.pixels.size(); i += 4) {
    if (a.pixels[i + 3] < 255 || b.pixels[i + 3] < 255) continue;
    ++compared;
    for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(int(a.pixels[i + k]) - int(b.pixels[i + k])));
  }
  EXPECT_GT(compared, 500);
  return largest;
}

const glm::u8vec4 kRed(200, 40, 10, 255), kBlue(20, 60, 220, 255);

Image filled(const PinholeCamera& camera, const glm::u8vec4& color) {
  Image image(camera.width, camera.height, 4);
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = color[i % 4];
  return image;
}

TEST_F(CamerasTest, ShowsWhatTheBenchmarkShows) {
  addQuad({0, 1, 0}, 0.5, 3);
  addQuad({-0.3, 1.1, 0.8}, 0.2);  // hides a part of the first from the left camera
  cameras_ = {lookAt({-1.5, 1.2, 3}, {0, 1, 0}, kSide, kSide, 60), lookAt({1.2, 0.8, 3}, {0, 1, 0}, 80, 72, 70),
              lookAt({0.2, 1.8, 3}, {0, 1, 0}, kSide, 48, 60)};
  std::vector<Image> pictures;
  for (int c = 0; c < 3; ++c) pictures.push_back(gradient(cameras_[c], c + 1));
  makeModel();
  tile(pictures, {{10, 4}, {100, 120}, {3, 190}});
  MeshTopology topology;
  topology.face_vertices = faces_;
  topology.vertex_count = static_cast<uint32_t>(positions_.size());
  for (const render::Visibility visibility : {render::Visibility::None, render::Visibility::Plain,
                                              render::Visibility::Offset, render::Visibility::Fattened}) {
    options_.method.visibility = visibility;
    auto fvvr = render::Fvvr::create(*device, cameras_, topology, {.visibility = visibility}).take();
    for (const int closest : {1, 2, 3}) {
      options_.method.closest = closest;
      const PinholeCamera view = lookAt({-0.4, 1.1, 2.6}, {0, 1, 0}, 96, 96, 100);
      ASSERT_TRUE(fvvr->setFrame(positions_, pictures));
      const Image expected = fvvr->renderStill(render::viewFromCamera(view), {.closest = closest, .samples = 4}).take();
      EXPECT_LE(largestDifference(still(view), expected), 2) << int(visibility) << ", " << closest << " cameras";
    }
  }
}

TEST_F(CamerasTest, AScaledTileOfAPartOfThePictureShowsTheSamePlaces) {
  addQuad({0, 1, 0}, 0.4);
  cameras_ = {lookAt({0.3, 1.2, 3}, {0, 1, 0}, kSide, kSide, 60)};
  makeModel();
  const PinholeCamera view = lookAt({-0.2, 0.9, 2.8}, {0, 1, 0}, 96, 96, 100);
  tile({gradient(cameras_[0], 1)}, {{8, 8}});
  const Image whole = still(view);
  // The middle of the picture, twice as large.
  Image scaled(kPicture, kPicture, 4, 0);
  const int from = 16, size = 32;
  for (int y = 0; y < 2 * size; ++y)
    for (int x = 0; x < 2 * size; ++x) {
      uint8_t* p = scaled.at(40 + x, 90 + y);
      p[0] = static_cast<uint8_t>(std::lround(3 * (from + (x + 0.5) / 2 - 0.5)));
      p[1] = static_cast<uint8_t>(std::lround(3 * (from + (y + 0.5) / 2 - 0.5)));
      p[2] = 60, p[3] = 255;
    }
  device->updateTexture(picture_.rgba.id(), {.width = kPicture, .height = kPicture}, scaled.pixels.data());
  sources_[0] = {{from, from, size, size}, glm::vec4(40, 90, 2 * size, 2 * size) / float(kPicture)};
  ++serial_;
  options_.method.unseen = render::Unseen::Transparent;
  const Image part = still(view);
  int compared = 0;
  for (size_t i = 0; i < part.pixels.size(); i += 4) {
    if (part.pixels[i + 3] < 255) continue;
    ++compared;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(part.pixels[i + k], whole.pixels[i + k], 3);
  }
  EXPECT_GT(compared, 400);
}

TEST_F(CamerasTest, DepthMapsAreDrawnOnlyWhenSurfaceOrCamerasChange) {
  addQuad({0, 1, 0}, 0.5);
  for (double x : {-2.0, -1.0, 0.0, 1.0, 2.0}) cameras_.push_back(lookAt({x, 1, 3}, {0, 1, 0}, kSide, kSide, 60));
  std::vector<Image> pictures;
  std::vector<glm::ivec2> at;
  for (int c = 0; c < 5; ++c) pictures.push_back(gradient(cameras_[c], c)), at.push_back({(c % 3) * 70, c / 3 * 70});
  makeModel();
  tile(pictures, at);
  options_.method.closest = 2;
  const PinholeCamera left = lookAt({-1.6, 1, 3}, {0, 1, 0}, kSide, kSide, 60),
                      nearby = lookAt({-1.4, 1, 3}, {0, 1, 0}, kSide, kSide, 60),
                      right = lookAt({1.6, 1, 3}, {0, 1, 0}, kSide, kSide, 60);
  const auto passes = [&](const PinholeCamera& view) {
    device->resetCounters();
    still(view);
    return device->counters().passes;
  };
  EXPECT_EQ(passes(left), 3u) << "two maps and the picture";
  EXPECT_EQ(passes(left), 1u);
  EXPECT_EQ(passes(nearby), 1u) << "the same cameras";
  EXPECT_EQ(passes(right), 3u);
  model_.setPositions(*device, positions_);
  EXPECT_EQ(passes(right), 3u) << "another frame";
  tile(pictures, at);
  EXPECT_EQ(passes(right), 1u) << "another picture of the same surface";
}

// A wall whose lower half no camera sees, behind a screen: it continues what lies above.
TEST_F(CamerasTest, UnseenSurfaceTakesItsNeighbourhoodsColour) {
  addQuad({0, 1, 0}, 0.5, 16);
  addQuad({0, 0.3, 0.4}, 0.45);
  cameras_ = {lookAt({0, 1.4, 3}, {0, 1, 0}, 128, 128, 130)};
  Image picture = filled(cameras_[0], kRed);
  for (int y = 0; y < 128; ++y)  // the screen is blue
    for (int x = 0; x < 128; ++x)
      if (y > cameras_[0].project({0, 0.72, 0.4}).y)
        for (int k = 0; k < 4; ++k) picture.at(x, y)[k] = kBlue[k];
  makeModel();
  tile({picture}, {{20, 30}});
  const PinholeCamera view = lookAt({0, 2.6, 1.2}, {0, 0.9, 0}, 128, 128, 110);
  const dvec3 hidden = view.project({0, 0.54, 0});
  const auto shown = [&](render::Unseen unseen) {
    options_.method.unseen = unseen;
    const Image image = still(view);
    const uint8_t* p = image.at(int(hidden.x), int(hidden.y));
    return glm::u8vec4(p[0], p[1], p[2], p[3]);
  };
  EXPECT_EQ(shown(render::Unseen::Transparent).a, 0);
  EXPECT_NEAR(shown(render::Unseen::BestFacing).b, kBlue.b, 8) << "the screen's colour falls onto it";
  const glm::u8vec4 color = shown(render::Unseen::Neighbourhood);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(color[k], kRed[k], 8);
}

// A part of the surface lies behind a camera: its box reaches round it, and the map still shows what hides what.
TEST_F(CamerasTest, SurfaceBehindACameraChangesNothingInFrontOfIt) {
  addQuad({0, 1, 0}, 0.5, 3);
  addQuad({-0.3, 1.1, 0.8}, 0.2);
  cameras_ = {lookAt({-0.8, 1.2, 1.6}, {0, 1, 0}, 96, 96, 60), lookAt({1.2, 0.8, 3}, {0, 1, 0}, 96, 96, 90)};
  const std::vector<Image> pictures = {gradient(cameras_[0], 1), gradient(cameras_[1], 2)};
  const PinholeCamera view = lookAt({-0.2, 1.1, 2.6}, {0, 1, 0}, 96, 96, 100);
  options_.method.unseen = render::Unseen::Transparent;
  makeModel();
  tile(pictures, {{10, 4}, {120, 120}});
  const Image before = still(view);
  addQuad({-1, 1.2, 4}, 0.1);
  makeModel();
  EXPECT_LE(largestDifference(still(view), before), 2);
}

TEST_F(CamerasTest, TwoFiguresOfOnePictureKeepTheirOwnMaps) {
  cameras_ = {lookAt({-1.2, 1.2, 3}, {0, 1, 0}, kSide, kSide, 60), lookAt({1.2, 0.8, 3}, {0, 1, 0}, kSide, kSide, 60)};
  addQuad({-0.25, 1, 0}, 0.2, 4);
  makeModel();
  render::CharacterModel left = std::move(model_);
  positions_.clear(), faces_.clear();
  addQuad({0.25, 1, 0.3}, 0.2, 2);
  makeModel();
  tile({gradient(cameras_[0], 1), gradient(cameras_[1], 2)}, {{10, 4}, {120, 120}});
  const PinholeCamera view = lookAt({0.1, 1.1, 2.6}, {0, 1, 0}, 96, 96, 100);
  const render::CameraLook look{cameras_, sources_, &picture_, glm::vec2(kPicture), serial_};
  const auto drawn = [&](std::vector<const render::CharacterModel*> models) {
    std::vector<render::Figure> figures(models.size());
    for (size_t i = 0; i < models.size(); ++i) figures[i].model = models[i], figures[i].cameras = &look;
    return drawnImage(*device, render::viewFromCamera(view), [&](gpu::TargetId target) {
      return recipe_->draw(figures, nullptr, render::viewFromCamera(view), options_, target);
    });
  };
  for (int round = 0; round < 2; ++round) {
    const Image both = drawn({&left, &model_}), swapped = drawn({&model_, &left}), one = drawn({&left}),
                other = drawn({&model_});
    EXPECT_EQ(both.pixels, swapped.pixels);
    int covered = 0;
    for (size_t i = 0; i < both.pixels.size(); i += 4) {
      const Image& alone = other.pixels[i + 3] == 255 ? other : one;
      if (alone.pixels[i + 3] < 255) continue;
      ++covered;
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(both.pixels[i + k], alone.pixels[i + k], 1);
    }
    EXPECT_GT(covered, 400);
  }
  left = {};
}

TEST_F(CamerasTest, ATopologyMayChangeFromFrameToFrame) {
  addQuad({0, 1, 0}, 0.4, 8);
  cameras_ = {lookAt({0.3, 1.2, 3}, {0, 1, 0}, kSide, kSide, 60)};
  makeModel();
  tile({gradient(cameras_[0], 1)}, {{8, 8}});
  const PinholeCamera view = lookAt({-0.2, 0.9, 2.8}, {0, 1, 0}, 96, 96, 100);
  options_.method.unseen = render::Unseen::Neighbourhood;
  const Image fine = still(view);
  faces_.clear(), positions_.clear();
  addQuad({0, 1, 0}, 0.4, 2);
  ASSERT_TRUE(model_.setTopology(*device, faces_, static_cast<uint32_t>(positions_.size())));
  model_.setPositions(*device, positions_);
  EXPECT_LE(largestDifference(still(view), fine), 2);
  EXPECT_FALSE(model_.setTopology(*device, std::vector<glm::uvec3>(1000), 9)) << "more faces than it was made for";
}

TEST_F(CamerasTest, SaysWhatIsMissing) {
  addQuad({0, 1, 0}, 0.4);
  cameras_ = {lookAt({0.3, 1.2, 3}, {0, 1, 0}, kSide, kSide, 60)};
  makeModel();
  tile({gradient(cameras_[0], 1)}, {{8, 8}});
  const PinholeCamera view = lookAt({-0.2, 0.9, 2.8}, {0, 1, 0}, 96, 96, 100);
  sources_[0].source.z = 0;
  EXPECT_NE(drawTo(view, gpu::kDefaultTarget).error().message.find("no camera has a picture"), std::string::npos);
  recipe_->setMethod(nullptr);
  EXPECT_EQ(drawTo(view, gpu::kDefaultTarget).error().id, ErrorId::Unsupported);
  EXPECT_FALSE(render::makeCameraMethod(*device, "no-such-method"));
}

}  // namespace
}  // namespace fourdvt::testing

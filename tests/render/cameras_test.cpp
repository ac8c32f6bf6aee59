// SPDX-License-Identifier: Apache-2.0
// Figures from cameras in the recipe: equality with the benchmark's picture of the same cameras, tiles anywhere in the
// decoded picture, reuse from picture to picture, and colours of unseen surface.
#include <cmath>

#include "camera_figure.h"
#include "render/cameras/fvvr.h"

namespace fourdvt::testing {
namespace {

class CamerasTest : public CameraFigure {};

TEST_F(CamerasTest, ShowsWhatTheBenchmarkShows) {
  addQuad({0, 1, 0}, 0.5, 3);
  addQuad({-0.3, 1.1, 0.8}, 0.2);  // hides a part of the first quad from the left camera
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
  // The same picture at twice the size.
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

// A wall behind a screen, with a lower half that no camera sees: it takes the colours above it.
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

// A part of the surface lies behind a camera: its projected box is unbounded, and occlusion must still be right.
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

// SPDX-License-Identifier: Apache-2.0
// Floating Textures: soft visibility against brute force, filling of holes, pictures displaced by a known shift, and
// reuse while the scene stands still.
#include <algorithm>
#include <cmath>
#include <random>

#include "camera_figure.h"
#include "render/cameras/floating_pictures.h"

namespace fourdvt::testing {
namespace {

using glm::dvec2;

constexpr int kPixels = 128;  // along each side of a camera's picture
constexpr double kFocal = 300, kDistance_m = 3, kMetresPerPixel = kDistance_m / kFocal;

PinholeCamera cameraAt(double x) { return lookAt({x, 1, kDistance_m}, {0, 1, 0}, kPixels, kPixels, kFocal); }

// Waves with periods of 7 to 60 pixels in many directions, 0…1.
double texture(dvec2 at_px) {
  constexpr int kWaves = 14;
  double sum = 0;
  for (int i = 0; i < kWaves; ++i) {
    const double wavelength = 7 * std::pow(60.0 / 7, i / (kWaves - 1.0)), angle = 2.4 * i;
    sum += std::sin(2 * M_PI / wavelength * (at_px.x * std::cos(angle) + at_px.y * std::sin(angle)) + i * i);
  }
  return glm::clamp(0.5 + 0.09 * sum, 0.0, 1.0);
}

// Level at a camera's pixel of the plane z = 0, with the texture moved by `shift_px` to the right and up, 0…255.
double levelAt(const PinholeCamera& camera, int x, int y, dvec2 shift_px) {
  const dvec3 in_cam((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1);
  const dvec3 ray = glm::transpose(glm::dmat3(camera.cam_from_world)) * in_cam, eye = camera.centreInWorld();
  return 255 * texture(dvec2(eye - eye.z / ray.z * ray) / kMetresPerPixel - shift_px);
}

Image textured(const PinholeCamera& camera, dvec2 shift_px) {
  Image image(camera.width, camera.height, 4, 255);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int k = 0; k < 3; ++k)
        image.at(x, y)[k] =
            static_cast<uint8_t>(k == 0 ? std::lrint(levelAt(camera, x, y, shift_px)) : image.at(x, y)[0]);
  return image;
}

Image textured(const PinholeCamera& camera, double shift_px) { return textured(camera, dvec2(shift_px, 0)); }

class FloatingTest : public CameraFigure {
 protected:
  FloatingTest() : CameraFigure(512) {}
  void SetUp() override {
    CameraFigure::SetUp();
    options_.method.min_cosine = render::MethodOptions().min_cosine;
  }

  void show(const std::vector<Image>& pictures) {
    makeModel();
    setPictures(pictures);
  }

  void setPictures(const std::vector<Image>& pictures) {
    std::vector<glm::ivec2> at;
    for (int c = 0; c < int(pictures.size()); ++c) at.emplace_back(c % 3 * (kPixels + 8), c / 3 * (kPixels + 8));
    tile(pictures, at);
  }

  Image stillBy(const char* method, const PinholeCamera& view) {
    recipe_->setMethod(render::makeCameraMethod(*device, method).take());
    return still(view);
  }

  // Two cameras: the left one's picture is moved by -shift, the right one's by +shift.
  void shiftedPair(double shift_px) {
    addQuad({0, 1, 0}, 0.5);
    cameras_ = {cameraAt(-0.5), cameraAt(0.5)};
    show({textured(cameras_[0], -shift_px), textured(cameras_[1], shift_px)});
  }
};

// Mean difference in levels, away from the quad's edge.
double meanDifference(const Image& a, const Image& b) {
  double sum = 0;
  int count = 0;
  for (int y = 30; y < kPixels - 30; ++y)
    for (int x = 30; x < kPixels - 30; ++x, ++count) sum += std::abs(int(a.at(x, y)[0]) - int(b.at(x, y)[0]));
  return sum / count;
}

double differenceAt(const Image& picture, const PinholeCamera& view, dvec2 shift_px) {
  double difference = 0;
  for (int y = 30; y < kPixels - 30; y += 4)
    for (int x = 30; x < kPixels - 30; x += 2)
      difference += std::abs(picture.at(x, y)[0] - levelAt(view, x, y, shift_px));
  return difference;
}

// Shift of the texture that matches the picture best, pixels.
double shiftOf(const Image& picture, const PinholeCamera& view) {
  double best = 0, least = HUGE_VAL;
  for (double shift = -3; shift <= 3; shift += 0.125)
    if (const double difference = differenceAt(picture, view, {shift, 0}); difference < least)
      least = difference, best = shift;
  return best;
}

TEST_F(FloatingTest, SoftVisibilityIsTheDistanceByBruteForce) {
  constexpr int kWidth = 53, kHeight = 41;
  std::mt19937 random(3);
  std::vector<uint8_t> hidden(4 * kWidth * kHeight, 0);
  for (int k = 0; k < 120; ++k)
    hidden[4 * (random() % (kWidth * kHeight)) + (k < 8 ? 0 : k < 20 ? 1 : 2)] = 255;  // none in the last channel
  auto mask = gpu::makeTexture(*device, {.width = kWidth, .height = kHeight, .label = "hidden"}).take();
  device->updateTexture(mask.id(), {.width = kWidth, .height = kHeight}, hidden.data());
  render::PictureGroup ones;
  ASSERT_TRUE(render::resizeGroup(*device, kWidth, kHeight, {gpu::PixelFormat::RGBA16F}, false, ones));
  device->beginPass({.target = ones.target.id(), .clear_color = true, .color = glm::vec4(1)});
  device->endPass();
  render::SoftVisibility soft;
  for (const float radius : {1.0f, 5.5f, 12.0f}) {
    ASSERT_TRUE(soft.update(*device, mask.id(), ones.textures[0].id(), kWidth, kHeight, radius));
    std::vector<glm::vec4> drawn(kWidth * kHeight);
    ASSERT_TRUE(device->readPixels(soft.target(), gpu::PixelFormat::RGBA16F, {.width = kWidth, .height = kHeight},
                                   drawn.data()));
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (int c = 0; c < 4; ++c) {
          double least = radius;
          for (int v = 0; v < kHeight; ++v)
            for (int u = 0; u < kWidth; ++u)
              if (hidden[4 * (v * kWidth + u) + c]) least = std::min(least, std::hypot(u - x, v - y));
          ASSERT_NEAR(drawn[(kHeight - 1 - y) * kWidth + x][c], least / radius, 2e-3)
              << x << ", " << y << ", channel " << c << ", radius " << radius;
        }
  }
}

// A screen hides a part of the wall from the camera nearest to the view. Background occludes nothing.
TEST_F(FloatingTest, AHoleShowsTheCameraOfTheLargestWeight) {
  addQuad({0, 1, 0}, 0.5);
  addQuad({0.05, 1, 0.6}, 0.1);
  cameras_ = {cameraAt(1.1), cameraAt(-0.9), cameraAt(0.3)};
  const glm::u8vec4 colors[] = {{230, 20, 10, 255}, {10, 220, 30, 255}, {30, 10, 240, 255}};
  std::vector<Image> pictures;
  for (const glm::u8vec4& color : colors) {
    pictures.emplace_back(kPixels, kPixels, 4);
    for (size_t i = 0; i < pictures.back().pixels.size(); ++i) pictures.back().pixels[i] = color[int(i % 4)];
  }
  show(pictures);
  const PinholeCamera at = lookAt({-0.1, 1, kDistance_m}, {0, 1, 0}, kPixels, kPixels, kFocal);
  const render::View seen = render::viewFromCamera(at);
  const render::CharacterView view{seen.clip_from_world, seen.eye_in_world, seen.width, seen.height};
  render::FigureCameras chosen;
  render::FloatingPictures floating;
  const render::CameraLook shown = look();
  ASSERT_TRUE(chosen.prepare(*device, model_, shown, view, options_.method, render::FloatingPictures::kMax));
  ASSERT_TRUE(floating.update(*device, model_, shown, view, options_.method, chosen));
  ASSERT_EQ(chosen.chosen(), (std::vector<size_t>{2, 1, 0}));
  const auto read = [&](gpu::TextureId texture, gpu::PixelFormat format, void* out) {
    auto target = gpu::makeTarget(*device, {.colors = {texture}, .label = "read"}).take();
    ASSERT_TRUE(device->readPixels(target.id(), format, {.width = kPixels, .height = kPixels}, out));
  };
  std::vector<glm::vec4> weights(kPixels * kPixels);
  read(floating.weights(), gpu::PixelFormat::RGBA16F, weights.data());
  int holes = 0;
  std::vector<glm::u8vec4> drawn(kPixels * kPixels);
  for (int rank = 0; rank < 3; ++rank) {
    read(floating.picture(rank), gpu::PixelFormat::RGBA8, drawn.data());
    for (int i = 0; i < kPixels * kPixels; ++i) {
      if (drawn[i].a == 0) continue;
      int best = 0;
      for (int k = 1; k < 3; ++k)
        if (weights[i][k] > weights[i][best]) best = k;
      ASSERT_GT(weights[i][best], 0);
      holes += weights[i][rank] == 0;
      ASSERT_EQ(drawn[i], colors[chosen.chosen()[weights[i][rank] > 0 ? rank : best]]) << "rank " << rank;
    }
  }
  EXPECT_GT(holes, 300);
  // Behind the screen, seen past its edge, the next camera by angle fills in; at the quad's own border weights do not
  // fade.
  const dvec3 behind = at.project({-0.09, 1, 0}), edge = at.project({0.49, 1.3, 0}), inside = at.project({0.3, 1.3, 0});
  const auto weightsAt = [&](const dvec3& pixel) { return weights[int(pixel.y) * kPixels + int(pixel.x)]; };
  read(floating.picture(0), gpu::PixelFormat::RGBA8, drawn.data());
  EXPECT_EQ(weightsAt(behind)[0], 0);
  EXPECT_EQ(drawn[int(behind.y) * kPixels + int(behind.x)], colors[1]);
  EXPECT_GT(weightsAt(edge)[1], 0.8 * weightsAt(inside)[1]);
}

TEST_F(FloatingTest, PicturesThatAreOffByAKnownShiftMeetBetween) {
  shiftedPair(1.75);
  const PinholeCamera middle = cameraAt(0), left = cameraAt(-0.3);
  const Image truth = textured(middle, 0);
  const double linear = meanDifference(stillBy("linear", middle), truth);
  EXPECT_GT(linear, 8);
  for (const char* method : {"floating", "floating-pairs", "floating-static"}) {
    const Image picture = stillBy(method, middle);
    EXPECT_LT(meanDifference(picture, truth), 0.2 * linear) << method;
    EXPECT_NEAR(shiftOf(picture, middle), 0, 0.2) << method;
    const double from_left = shiftOf(stillBy(method, left), left);
    EXPECT_LT(from_left, -0.5) << method << ": the nearer picture moves less";
    EXPECT_GT(from_left, -1.75) << method;
  }
}

// The first round brings the pictures close together; the second needs its result, a nearly sharp mean.
TEST_F(FloatingTest, TheStarFindsWhatItsFirstMeanBlurs) {
  shiftedPair(3);
  const PinholeCamera middle = cameraAt(0);
  const Image truth = textured(middle, 0);
  const double linear = meanDifference(stillBy("linear", middle), truth);
  EXPECT_LT(meanDifference(stillBy("floating", middle), truth), 0.25 * linear);
}

// Wall seen by three cameras at 40 to 50 degrees, two pictures displaced along both axes. The truth lies in the middle
// of their contents.
TEST_F(FloatingTest, StillModeBringsObliquePicturesTogether) {
  addQuad({0, 1, 0}, 0.5);
  cameras_ = {lookAt({-2.3, 1, 1.93}, {0, 1, 0}, kPixels, kPixels, kFocal),
              lookAt({0, 2.9, 2.3}, {0, 1, 0}, kPixels, kPixels, kFocal),
              lookAt({2.3, 1, 1.93}, {0, 1, 0}, kPixels, kPixels, kFocal)};
  const dvec2 shift_px(1.5, -1.25);
  show({textured(cameras_[0], -shift_px), textured(cameras_[1], 0), textured(cameras_[2], shift_px)});
  for (const double height : {1.0, 1.7}) {
    const PinholeCamera view = lookAt({0, height, kDistance_m}, {0, 1, 0}, kPixels, kPixels, kFocal);
    const Image linear = stillBy("linear", view), still = stillBy("floating-static", view);
    const Image truth = textured(view, 0);
    EXPECT_LT(meanDifference(still, truth), 0.4 * meanDifference(linear, truth)) << height;
    const double here = differenceAt(still, view, {0, 0});
    for (const dvec2 off : {dvec2(0.4, 0), dvec2(-0.4, 0), dvec2(0, 0.4), dvec2(0, -0.4)})
      EXPECT_LT(here, differenceAt(still, view, off)) << height << ": " << off.x << ", " << off.y;
  }
}

// Stripes of one pixel in the camera's picture, seen at half the size, on small triangles.
TEST_F(FloatingTest, StillModeShowsThePixelsArea) {
  addQuad({0, 1, 0}, 0.5, 32);
  cameras_ = {cameraAt(0)};
  constexpr int kSide = kPixels / 2;
  for (const bool across : {false, true}) {
    Image stripes(kPixels, kPixels, 4, 255);
    for (int y = 0; y < kPixels; ++y)
      for (int x = 0; x < kPixels; ++x)
        for (int k = 0; k < 3; ++k) stripes.at(x, y)[k] = (across ? y : x) % 2 ? 228 : 28;
    show({stripes});
    const dvec3 off(across ? 0 : 0.013, across ? 0.013 : 0, 0);
    const Image picture = stillBy(
        "floating-static", lookAt(dvec3(0, 1, kDistance_m) + off, dvec3(0, 1, 0) + off, kSide, kSide, kFocal / 2));
    for (int y = kSide / 4; y < 3 * kSide / 4; ++y)
      for (int x = kSide / 4; x < 3 * kSide / 4; ++x)
        ASSERT_NEAR(picture.at(x, y)[0], 128, 30) << x << ", " << y << (across ? ", across" : "");
  }
}

// The cameras miss a part of a wall behind a red screen. Still mode shows there the same as the blend without flow, up
// to the part's border.
TEST_F(FloatingTest, StillModeShowsWhatNoCameraSeesAsWithoutFlow) {
  addQuad({0, 1, 0}, 0.5);
  addQuad({0, 1, 0.6}, 0.1);
  cameras_ = {cameraAt(-0.1), cameraAt(0.1)};
  std::vector<Image> pictures;
  for (const PinholeCamera& camera : cameras_) {
    pictures.emplace_back(kPixels, kPixels, 4, 255);
    const dvec3 low = camera.project({-0.1, 0.9, 0.6}), high = camera.project({0.1, 1.1, 0.6});
    for (int y = 0; y < kPixels; ++y)
      for (int x = 0; x < kPixels; ++x) {
        const bool is_screen = x + 0.5 > low.x && x + 0.5 < high.x && y + 0.5 > std::min(low.y, high.y) &&
                               y + 0.5 < std::max(low.y, high.y);
        const glm::u8vec4 color = is_screen ? glm::u8vec4(230, 20, 10, 255) : glm::u8vec4(10, 220, 30, 255);
        for (int k = 0; k < 4; ++k) pictures.back().at(x, y)[k] = color[k];
      }
  }
  show(pictures);
  const PinholeCamera aside = lookAt({2, 1, 2.5}, {0, 1, 0}, kPixels, kPixels, kFocal);
  const Image kept = stillBy("floating-static", aside), plain = stillBy("linear", aside);
  const auto isRed = [](const uint8_t* pixel) { return pixel[3] > 200 && pixel[0] > 120; };
  int on_screen = 0, beside = 0;
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x)
      if (isRed(kept.at(x, y))) (isRed(plain.at(x, y)) ? on_screen : beside) += 1;
  EXPECT_GT(on_screen, 300);
  EXPECT_LE(beside, 2);
}

// Displacements of a flow of half the size are doubled. They count in full up to the bound, and not at all from twice
// the bound. A sum of a quarter of the size gives the same.
TEST_F(FloatingTest, LongDisplacementsAreNotTaken) {
  constexpr int kSide = 200;
  render::PictureGroup weights, flow, sum, small;
  ASSERT_TRUE(render::resizeGroup(*device, kSide, kSide, {gpu::PixelFormat::RGBA16F}, false, weights));
  ASSERT_TRUE(render::resizeGroup(*device, kSide / 2, kSide / 2, {gpu::PixelFormat::RG16F}, false, flow));
  ASSERT_TRUE(render::resizeGroup(*device, kSide, kSide, {gpu::PixelFormat::RG16F}, false, sum));
  ASSERT_TRUE(render::resizeGroup(*device, kSide / 4, kSide / 4, {gpu::PixelFormat::RG16F}, false, small));
  const auto fill = [&](const render::PictureGroup& group, const glm::vec4& value) {
    device->beginPass({.target = group.target.id(), .clear_color = true, .color = value});
    device->endPass();
  };
  fill(weights, glm::vec4(1));
  render::FlowSum add;
  const struct {
    float flow, most, sum;  // pixels of the flow, heights, pixels of the sum
  } cases[] = {{2.5f, 0.03f, 5}, {4.5f, 0.03f, 4.5f}, {6, 0.03f, 0}, {2, 0.001f, 4}, {4, 0.001f, 0}, {8, 1, 16}};
  for (const auto& c : cases) {
    fill(flow, glm::vec4(0, c.flow, 0, 0));
    for (const render::PictureGroup* to : {&sum, &small}) {
      ASSERT_TRUE(add.draw(*device,
                           {.flow = flow.textures[0].id(),
                            .weights = weights.textures[0].id(),
                            .most = c.most,
                            .scale = glm::vec2(float(kSide) / float(to->width))},
                           to->target.id()));
      std::vector<glm::vec2> drawn(to->width * to->height);
      ASSERT_TRUE(device->readPixels(to->target.id(), gpu::PixelFormat::RG16F,
                                     {.width = to->width, .height = to->height}, drawn.data()));
      EXPECT_NEAR(drawn[drawn.size() / 2].y, c.sum, 0.02) << c.flow << ", " << c.most << ", " << to->width;
      EXPECT_EQ(drawn[drawn.size() / 2].x, 0);
    }
  }
}

TEST_F(FloatingTest, PicturesThatAgreeAreLeftAlone) {
  shiftedPair(0);
  const PinholeCamera view = cameraAt(0.1);
  const Image linear = stillBy("linear", view);
  for (const char* method : {"floating", "floating-pairs", "floating-static"})
    EXPECT_LT(meanDifference(stillBy(method, view), linear), 1.5) << method;
}

TEST_F(FloatingTest, AStillSceneIsALookUp) {
  shiftedPair(1.5);
  const auto passes = [&](const PinholeCamera& view) {
    device->resetCounters();
    still(view);
    return device->counters().passes;
  };
  stillBy("floating-static", cameraAt(0));
  EXPECT_LE(passes(cameraAt(0.1)), 4u) << "sight, soft visibility and the picture";
  setPictures({textured(cameras_[0], 0), textured(cameras_[1], 0)});
  EXPECT_GT(passes(cameraAt(0.1)), 20u);
  model_.setPositions(*device, positions_);
  EXPECT_GT(passes(cameraAt(0.1)), 20u);
  EXPECT_LE(passes(cameraAt(0)), 4u);
}

TEST_F(FloatingTest, TexturesShrinkWithTheView) {
  shiftedPair(0);
  for (const char* method : {"floating", "floating-pairs", "floating-static"}) {
    stillBy(method, cameraAt(0));
    const uint64_t large = device->counters().live_texture_bytes;
    still(lookAt({0, 1, kDistance_m}, {0, 1, 0}, kPixels / 2, kPixels / 2, kFocal / 2));
    EXPECT_LT(device->counters().live_texture_bytes, large) << method;
  }
}

// The mean form starts at a quarter of the view's size, seldom a whole number of pixels. Views below 64 pixels have no
// flow.
TEST_F(FloatingTest, ViewsOfAnySize) {
  shiftedPair(1.5);
  for (const glm::ivec2 size : {glm::ivec2(77, 109), glm::ivec2(131, 101), glm::ivec2(64, 64), glm::ivec2(63, 90)}) {
    const PinholeCamera view =
        lookAt({0, 1, kDistance_m}, {0, 1, 0}, size.x, size.y, kFocal * std::min(size.x, size.y) / kPixels);
    const Image linear = stillBy("linear", view), mean = stillBy("floating", view), truth = textured(view, 0);
    double without = 0, with = 0;
    for (size_t i = 0; i < mean.pixels.size(); i += 4) {
      ASSERT_EQ(mean.pixels[i + 3], linear.pixels[i + 3]);
      if (mean.pixels[i + 3] < 255) continue;
      without += std::abs(int(linear.pixels[i]) - int(truth.pixels[i]));
      with += std::abs(int(mean.pixels[i]) - int(truth.pixels[i]));
    }
    EXPECT_GT(without, 0);
    if (size.x < 64)
      EXPECT_EQ(with, without);
    else
      EXPECT_LT(with, (size.x == 64 ? 0.95 : 0.6) * without) << size.x << " x " << size.y;
  }
}

// A figure from two cameras and one from three, side by side, take turns with the mean form.
TEST_F(FloatingTest, FiguresOfDifferentNumbersOfCameras) {
  addQuad({0, 1, 0}, 0.4);
  cameras_ = {cameraAt(-0.6), cameraAt(0.1), cameraAt(0.6)};
  show({textured(cameras_[0], -1), textured(cameras_[1], 0), textured(cameras_[2], 1)});
  recipe_->setMethod(render::makeCameraMethod(*device, "floating").take());
  const render::CharacterModel other = std::move(model_);
  makeModel();
  const render::CameraLook three = look();
  render::CameraLook two = three;
  two.cameras = two.cameras.subspan(0, 2);
  two.sources = two.sources.subspan(0, 2);
  render::Figure left, right;
  left.model = &model_, right.model = &other;
  left.cameras = &three, right.cameras = &two;
  left.world_from_character[3] = glm::vec4(-0.45, 0, 0, 1), right.world_from_character[3] = glm::vec4(0.45, 0, 0, 1);
  const render::View view = render::viewFromCamera(lookAt({0, 1, kDistance_m}, {0, 1, 0}, 200, kPixels, kFocal));
  const auto drawn = [&](std::span<const render::Figure> figures) {
    return drawnImage(*device, view,
                      [&](gpu::TargetId target) { return recipe_->draw(figures, nullptr, view, options_, target); });
  };
  const render::Figure figures[] = {right, left};
  const Image both = drawn(figures), first = drawn({&left, 1}), second = drawn({&right, 1});
  int compared = 0;
  for (size_t i = 0; i < both.pixels.size(); i += 4) {
    if (both.pixels[i + 3] < 255) continue;
    const Image& alone = first.pixels[i + 3] == 255 ? first : second;
    ++compared;
    for (int k = 0; k < 3; ++k) ASSERT_LE(std::abs(int(both.pixels[i + k]) - int(alone.pixels[i + k])), 1);
  }
  EXPECT_GT(compared, 8000);
}

TEST(FloatingUnsupported, WithoutHalfFloatTargets) {
  const auto device = gpu::createNullDevice(false);
  for (const char* method : {"linear", "floating", "floating-pairs", "floating-static"}) {
    const auto made = render::makeCameraMethod(*device, method);
    ASSERT_FALSE(made) << method;
    EXPECT_EQ(made.error().id, ErrorId::Unsupported) << method;
  }
}

}  // namespace
}  // namespace fourdvt::testing

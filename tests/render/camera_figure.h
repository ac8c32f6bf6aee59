// SPDX-License-Identifier: Apache-2.0
// Quads seen by cameras with synthetic pictures, drawn by a method through the recipe.
#pragma once

#include "gl_fixture.h"
#include "render/cameras/camera_method.h"
#include "render/recipe.h"

namespace fourdvt::testing {

using glm::dvec3;

constexpr int kSide = 64, kPicture = 256;  // defaults: pixels a side of a camera, texels a side of the decoded picture

class CameraFigure : public GlFixture {
 protected:
  explicit CameraFigure(int picture_side = kPicture) : picture_side_(picture_side) {}

  void SetUp() override {
    GlFixture::SetUp();
    picture_ = render::createPicture(*device, picture_side_, picture_side_, render::PictureTextures::Kind::Rgba).take();
    recipe_ = render::Recipe::create(*device).take();
    recipe_->setMethod(render::makeCameraMethod(*device, "fvvr").take());
    options_.recipe = {.background = {0, 0, 0, 0}, .ground_shadow = false};
    options_.method = {.closest = 0, .unseen = render::Unseen::BestFacing, .min_cosine = 0};
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
    character.length_scale = length_scale_;
    character.vertex_count = static_cast<uint32_t>(positions_.size()) + 7;  // frames may have fewer than the maximum
    character.face_count = static_cast<uint32_t>(faces_.size()) + 5;
    model_ = render::CharacterModel::createForSurfaces(*device, character).take();
    ASSERT_TRUE(model_.setTopology(*device, faces_, static_cast<uint32_t>(positions_.size())));
    model_.setPositions(*device, positions_);
  }

  // Copies camera pictures into the decoded picture, each whole, with its corner at `at`.
  void tile(const std::vector<Image>& pictures, const std::vector<glm::ivec2>& at) {
    Image whole(picture_side_, picture_side_, 4, 77);
    sources_.clear();
    for (size_t c = 0; c < pictures.size(); ++c) {
      for (int y = 0; y < pictures[c].height; ++y)
        for (int x = 0; x < pictures[c].width; ++x)
          for (int k = 0; k < 4; ++k) whole.at(at[c].x + x, at[c].y + y)[k] = pictures[c].at(x, y)[k];
      const glm::vec2 size(pictures[c].width, pictures[c].height);
      sources_.push_back({{0, 0, size}, glm::vec4(at[c], size) / float(picture_side_)});
    }
    device->updateTexture(picture_.rgba.id(), {.width = picture_side_, .height = picture_side_}, whole.pixels.data());
    ++serial_;
  }

  render::CameraLook look() const { return {cameras_, sources_, &picture_, glm::vec2(picture_side_), serial_}; }

  render::View viewOf(const PinholeCamera& camera) const {
    return render::viewFromCamera(camera, {float(length_scale_), float(length_scale_)});
  }

  Status drawTo(const PinholeCamera& view, gpu::TargetId target) {
    const render::CameraLook shown = look();
    render::Figure figure;
    figure.model = &model_;
    figure.cameras = &shown;
    return recipe_->draw({&figure, 1}, nullptr, viewOf(view), options_, target);
  }

  Image still(const PinholeCamera& view) {
    Image image = drawnImage(*device, viewOf(view), [&](gpu::TargetId target) { return drawTo(view, target); });
    remember(image);
    return image;
  }

  const int picture_side_;  // texels of the decoded picture
  std::vector<glm::uvec3> faces_;
  Positions positions_;
  std::vector<PinholeCamera> cameras_;
  std::vector<render::CameraSource> sources_;
  render::CharacterModel model_;
  render::PictureTextures picture_;
  std::unique_ptr<render::Recipe> recipe_;
  render::DrawOptions options_;
  uint64_t serial_ = 0;
  double length_scale_ = 1;
};

// Red rises with x, green with y; blue: the camera's number.
inline Image gradient(const PinholeCamera& camera, int number) {
  Image image(camera.width, camera.height, 4, 255);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      uint8_t* p = image.at(x, y);
      p[0] = static_cast<uint8_t>(3 * x), p[1] = static_cast<uint8_t>(3 * y), p[2] = static_cast<uint8_t>(60 * number);
    }
  return image;
}

// Largest difference over pixels that both pictures cover fully.
inline int largestDifference(const Image& a, const Image& b) {
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

inline Image filled(const PinholeCamera& camera, const glm::u8vec4& color) {
  Image image(camera.width, camera.height, 4);
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = color[i % 4];
  return image;
}

}  // namespace fourdvt::testing

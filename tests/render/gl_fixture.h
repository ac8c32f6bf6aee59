// SPDX-License-Identifier: Apache-2.0
// A GLES device on a headless context, drawing into memory; a failed test saves its picture.
#pragma once

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <string>

#include "platform/egl_context.h"
#include "platform/files.h"
#include "quad_scene.h"

namespace fourdvt::testing {

class GlFixture : public ::testing::Test {
 protected:
  void SetUp() override {
    auto context = platform::EglContext::create();
    ASSERT_TRUE(context) << context.error().message;
    context_ = context.take();
    auto made = gpu::createGlesDevice();
    ASSERT_TRUE(made) << made.error().message;
    device = made.take();
  }

  // Checks that every test ends without misuse or GL errors; a failed one leaves its last picture in the build folder.
  void TearDown() override {
    if (device) {
      EXPECT_EQ(device->takeErrors(), "");
    }
    if (HasFailure() && !last_picture_.empty()) {
      const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
      mkdir("render_failures", 0755);
      const std::string path = std::string("render_failures/") + info->test_suite_name() + "." + info->name() + ".png";
      if (platform::writeImage(path, last_picture_)) printf("actual picture: %s\n", path.c_str());
    }
    device.reset();
    context_.reset();
  }

  void remember(const Image& picture) { last_picture_ = picture; }

  std::unique_ptr<platform::EglContext> context_;
  std::unique_ptr<gpu::Device> device;

 private:
  Image last_picture_;
};

// Picture that `draw` makes of the view: RGBA as drawn (premultiplied), top row first.
template <class Draw>
Image drawnImage(gpu::Device& device, const render::View& view, const Draw& draw) {
  Image out(view.width, view.height, 4);
  auto color = gpu::makeTexture(device, {.width = view.width, .height = view.height, .label = "still"}).take();
  auto target = gpu::makeTarget(device, {.colors = {color.id()}, .label = "still"}).take();
  const Status drawn = draw(target.id());
  EXPECT_TRUE(drawn) << drawn.error().message;
  const Status read = device.readPixels(target.id(), gpu::PixelFormat::RGBA8,
                                        {.width = view.width, .height = view.height}, out.pixels.data());
  EXPECT_TRUE(read) << read.error().message;
  return out;
}

// Draws stills of a scene with one picture on the GPU. Must be destroyed before the fixture's device.
class Still {
 public:
  Still(gpu::Device& device, const Scene& scene, render::PictureTextures::Kind kind) : device_(device) {
    figure = render::PlainFigure::create(device, scene.character, scene.mesh).take();
    figure.setLayout(scene.rendition);
    figure.setFrame(device, scene.mesh.positions, scene.labels);
    picture = render::createPicture(device, scene.rendition.width, scene.rendition.height, kind).take();
    auto made = render::Recipe::create(device);
    EXPECT_TRUE(made) << (made ? "" : made.error().message);
    recipe = made.take();
  }

  void uploadRgba(const Image& image) {
    device_.updateTexture(picture.rgba.id(), {.width = image.width, .height = image.height}, image.pixels.data());
  }

  // RGBA as drawn (premultiplied), top row first.
  Image draw(const render::View& view, const render::RecipeOptions& options) {
    return drawnImage(device_, view,
                      [&](gpu::TargetId target) { return figure.draw(*recipe, picture, view, options, target); });
  }

  render::PlainFigure figure;
  render::PictureTextures picture;
  std::unique_ptr<render::Recipe> recipe;

 private:
  gpu::Device& device_;
};

}  // namespace fourdvt::testing

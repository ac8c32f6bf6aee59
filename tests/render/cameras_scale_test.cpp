// SPDX-License-Identifier: Apache-2.0
// Small and large characters from cameras (figurine, crane) look like one of a person's size: all lengths follow the
// length scale. A screen 5 cm in front of a wall makes depth tolerances matter.
#include "../unit/scaled.h"
#include "camera_figure.h"

namespace fourdvt::testing {
namespace {

constexpr double kScales[] = {0.05, 20};

class ScaledCamerasTest : public CameraFigure, public ::testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    CameraFigure::SetUp();
    recipe_->setMethod(render::makeCameraMethod(*device, GetParam()).take());
    options_.method.unseen = render::Unseen::Neighbourhood;
    addQuad({0, 1, 0}, 0.5, 12);
    addQuad({-0.1, 1.1, 0.05}, 0.2, 6);
    addQuad({0.3, 0.8, 0.3}, 0.1, 2);
    own_cameras_ = {lookAt({-1.5, 1.2, 3}, {0, 1, 0}, kSide, kSide, 60),
                    lookAt({1.2, 0.8, 3}, {0, 1, 0}, kSide, kSide, 70),
                    lookAt({0.2, 1.8, 3}, {0, 1, 0}, kSide, kSide, 60)};
    own_positions_ = positions_;
    std::vector<Image> pictures;
    for (int c = 0; c < 3; ++c) pictures.push_back(stripes(c));
    tile(pictures, {{10, 4}, {100, 120}, {3, 190}});
  }

  // Stripes of 6 pixels in a colour per camera, which reveals the choice of cameras.
  Image stripes(int camera) const {
    Image image = gradient(own_cameras_[size_t(camera)], camera + 1);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        if ((x + y * camera) / 6 % 2) image.at(x, y)[camera] = 250;
    return image;
  }

  Image at(double scale) {
    cameras_.clear();
    for (const PinholeCamera& camera : own_cameras_) cameras_.push_back(scaled(camera, scale));
    positions_ = scaled(own_positions_, scale);
    length_scale_ = scale;
    makeModel();
    ++serial_;
    return still(scaled(lookAt({-0.4, 1.1, 2.6}, {0, 1, 0}, 96, 96, 100), scale));
  }

  std::vector<PinholeCamera> own_cameras_;
  Positions own_positions_;
};

TEST_P(ScaledCamerasTest, LooksTheSameAtAnySize) {
  const Image person = at(1);
  for (const double scale : kScales) EXPECT_LT(shareThatDiffers(person, at(scale), 3), 0.01) << scale;
}

INSTANTIATE_TEST_SUITE_P(Methods, ScaledCamerasTest,
                         ::testing::Values("fvvr", "lumigraph", "band-limited", "holoportation", "montage4d", "sweep"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace fourdvt::testing

// SPDX-License-Identifier: Apache-2.0
// The method "sweep" with known truth: a textured wall behind the given surface, walls without texture, cameras
// occluded by a screen, and views of changing size.
#include "render/cameras/sweep.h"

#include <cmath>

#include "camera_figure.h"
#include "wall_pictures.h"

namespace fourdvt::testing {
namespace {

constexpr double kBehind_m = 0.01;

class SweepTest : public CameraFigure {
 protected:
  void SetUp() override {
    CameraFigure::SetUp();
    auto made = std::make_unique<render::Sweep>();
    sweep_ = made.get();
    recipe_->setMethod(std::move(made));
    options_.method.sweep = {.planes = 16, .band_m = 0.03f};
  }

  // Three cameras in front of the wall, the outer ones a metre to the side, and the surface 1 cm in front of the wall.
  void wallBehindItsSurface() {
    addQuad({0, 1, 0}, 0.25, 4);
    for (double x : {-1.0, 0.2, 1.0}) cameras_.push_back(lookAt({x, 1.1, 2}, {0, 1, 0}, 120, 120, 360));
    makeModel();
    std::vector<Image> pictures;
    for (const PinholeCamera& camera : cameras_) pictures.push_back(wall(camera, -kBehind_m));
    tile(pictures, {{4, 4}, {130, 4}, {4, 130}});
  }

  double meanError(const Image& image, const Image& truth) const {
    double sum = 0;
    int count = 0;
    for (size_t i = 0; i < image.pixels.size(); i += 4)
      for (int k = 0; k < 3 && image.pixels[i + 3] == 255; ++k, ++count)
        sum += std::abs(int(image.pixels[i + size_t(k)]) - int(truth.pixels[i + size_t(k)]));
    EXPECT_GT(count, 3000);
    return sum / count;
  }

  // Shifts of the last picture on the surface, metres behind it along the rays.
  std::vector<float> shifts() const {
    auto read = sweep_->readShifts(*device, 0);
    EXPECT_TRUE(read);
    std::vector<float> out;
    for (float shift : read.value())
      if (!std::isnan(shift)) out.push_back(shift);
    EXPECT_GT(out.size(), 500u);
    return out;
  }

  render::Sweep* sweep_ = nullptr;
  const PinholeCamera view_ = lookAt({-0.3, 1.05, 2.1}, {0, 1, 0}, 112, 112, 360);
};

TEST_F(SweepTest, FindsAWallBehindItsSurfaceAndShowsItWhereItIs) {
  wallBehindItsSurface();
  const Image truth = wall(view_, -kBehind_m);
  const double error = meanError(still(view_), truth);
  const float half_step = 0.5f * (options_.method.sweep.band_m + render::Sweep::kBefore_m) / 15;
  const std::vector<float> found = shifts();
  const auto near = std::count_if(found.begin(), found.end(),
                                  [&](float shift) { return std::abs(shift - kBehind_m) < half_step + 2e-4; });
  EXPECT_GT(double(near), 0.95 * double(found.size()));
  recipe_->setMethod(render::makeCameraMethod(*device, "fvvr").take());
  const double before = meanError(still(view_), truth);
  EXPECT_GT(before, 4) << "what there is to repair";
  EXPECT_LT(error, before / 3);
}

TEST_F(SweepTest, StaysOnTheSurfaceWhereThePicturesShowNothingToMatch) {
  wallBehindItsSurface();
  tile({filled(cameras_[0], kRed), filled(cameras_[1], kRed), filled(cameras_[2], kRed)}, {{4, 4}, {130, 4}, {4, 130}});
  const Image image = still(view_);
  for (float shift : shifts()) ASSERT_NEAR(shift, 0, 5e-4);
  for (size_t i = 0; i < image.pixels.size(); i += 4) {
    if (image.pixels[i + 3] < 255) continue;
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(image.pixels[i + size_t(k)], kRed[k], 1);
  }
}

// A screen in front of the right camera, beside the view's rays. It is painted as that camera would see the wall if it
// stood elsewhere in the band.
TEST_F(SweepTest, ACameraThatIsHiddenHasNoVote) {
  addQuad({0.45, 1.05, 1.2}, 0.14, 2);
  wallBehindItsSurface();
  std::vector<Image> pictures;
  for (const PinholeCamera& camera : cameras_) {
    pictures.push_back(wall(camera, -kBehind_m));
    const Image painted = wall(camera, -2.5 * kBehind_m);
    const dvec3 low = camera.project({0.31, 0.91, 1.2}), high = camera.project({0.59, 1.19, 1.2});
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x)
        if (x + 0.5 > low.x && x + 0.5 < high.x && y + 0.5 < low.y && y + 0.5 > high.y)
          for (int k = 0; k < 3; ++k) pictures.back().at(x, y)[k] = painted.at(x, y)[k];
  }
  tile(pictures, {{4, 4}, {130, 4}, {4, 130}});
  const PinholeCamera left = lookAt({-0.5, 1.05, 2.1}, {-0.05, 1, 0}, 112, 112, 400);
  const double error = meanError(still(left), wall(left, -kBehind_m));
  const std::vector<float> found = shifts();
  const auto right =
      std::count_if(found.begin(), found.end(), [](float shift) { return std::abs(shift - kBehind_m) < 0.002; });
  EXPECT_LT(error, 2);
  EXPECT_GT(double(right), 0.95 * double(found.size()));
}

TEST_F(SweepTest, ViewsAndPlanesMayChange) {
  wallBehindItsSurface();
  const PinholeCamera small = lookAt({-0.3, 1.05, 2.1}, {0, 1, 0}, 77, 91, 280);
  still(small);
  const Image large = still(view_);
  options_.method.sweep.planes = 8;
  const Image coarse = still(view_);
  recipe_->setMethod(std::make_unique<render::Sweep>());
  EXPECT_EQ(still(view_).pixels, coarse.pixels);
  options_.method.sweep.planes = 16;
  EXPECT_EQ(still(view_).pixels, large.pixels);
}

TEST_F(SweepTest, IsKeptWhileNothingChanges) {
  wallBehindItsSurface();
  options_.method.sweep.planes = 8;
  const auto passes = [&](const PinholeCamera& view) {
    device->resetCounters();
    still(view);
    return device->counters().passes;
  };
  const uint64_t sweep = 1 + 2 + 2 * 2 + 1, maps = 3;  // surface, costs, means, shifts
  EXPECT_EQ(passes(view_), maps + sweep + 1);
  EXPECT_EQ(passes(view_), 1u);
  const PinholeCamera other = lookAt({-0.3, 1.05, 2.2}, {0, 1, 0}, 112, 112, 360);
  EXPECT_EQ(passes(other), sweep + 1) << "another view";
  ++serial_;
  EXPECT_EQ(passes(other), sweep + 1) << "another picture";
  options_.method.sweep.band_m = 0.02f;
  EXPECT_EQ(passes(other), sweep + 1) << "another band";
  model_.setPositions(*device, positions_);
  EXPECT_EQ(passes(other), maps + sweep + 1) << "another frame";
}

TEST_F(SweepTest, SaysWhichOptionsItCannotUse) {
  wallBehindItsSurface();
  for (const render::SweepOptions& wrong :
       {render::SweepOptions{.planes = 6}, render::SweepOptions{.planes = 36}, render::SweepOptions{.band_m = 0}}) {
    options_.method.sweep = wrong;
    EXPECT_EQ(drawTo(view_, gpu::kDefaultTarget).error().id, ErrorId::InvalidArgument);
  }
}

}  // namespace
}  // namespace fourdvt::testing
